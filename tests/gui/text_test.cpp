// How numbers are written for the operator.
#include "gui/text.h"

#include <QLocale>
#include <catch2/catch.hpp>

namespace cnc::gui {

TEST_CASE("A position has a point, three decimals and a true minus in every locale",
          "[gui][GUI-2]") {
  QLocale::setDefault(QLocale(QLocale::German));
  CHECK(position_text(-1234.5678).toStdString() == "−1234.568");
  CHECK(position_text(0.0).toStdString() == "0.000");
  QLocale::setDefault(QLocale::c());
}

TEST_CASE("A position that rounds to zero has no sign", "[gui][GUI-2]") {
  CHECK(position_text(-0.0004).toStdString() == "0.000");
  CHECK(position_text(-0.0006).toStdString() == "−0.001");
}

TEST_CASE("A typed number may have a comma and a true minus", "[gui][LNG-4]") {
  CHECK(number_of("12.5") == 12.5);
  CHECK(number_of(" −12,5 ") == -12.5);
  CHECK_FALSE(number_of("12 mm"));
  CHECK_FALSE(number_of("1e999"));
  CHECK(value_text(20.0).toStdString() == "20");
  CHECK(value_text(-0.1).toStdString() == "-0.1");
}

TEST_CASE("Durations are minutes and seconds, with hours when there are any", "[gui][GUI-2]") {
  CHECK(duration_text(7.0) == "0:07");
  CHECK(duration_text(754.4) == "12:34");
  CHECK(duration_text(3723.0) == "1:02:03");
  CHECK(duration_text(-1.0) == "0:00");
}

TEST_CASE("Work systems 1 to 9 read G54 to G59.3", "[gui][GUI-2]") {
  CHECK(work_system_text(1) == "G54");
  CHECK(work_system_text(6) == "G59");
  CHECK(work_system_text(7) == "G59.1");
  CHECK(work_system_text(9) == "G59.3");
}

}  // namespace cnc::gui
