// The connection without a server: it says so, answers requests, and never waits.
#include "gui/connection.h"

#include <QTemporaryDir>
#include <catch2/catch.hpp>

#include "tests/gui/support.h"

namespace cnc::gui::test {

TEST_CASE("Where no server listens, the screen is told and every request is answered",
          "[gui][socket]") {
  application();
  const QTemporaryDir folder;
  Connection connection("unix://" + folder.filePath("nobody.sock").toStdString());
  QString reason;
  std::vector<api::Error> errors;
  QObject::connect(&connection, &Connection::disconnected, &connection,
                   [&](const QString& why) { reason = why; });
  QObject::connect(&connection, &Connection::refused, &connection,
                   [&](const Request&, const api::Error& error) { errors.push_back(error); });

  connection.start();
  connection.execute(Home{});
  connection.execute(Reset{});
  CHECK(wait_until([&] { return !reason.isEmpty() && errors.size() == 2; }));
  for (const api::Error& error : errors) CHECK(error.kind == api::ErrorKind::unavailable);
}

TEST_CASE("A jog without a server is refused by one of its renewals", "[gui][socket][MAN-1]") {
  application();
  const QTemporaryDir folder;
  Connection connection("unix://" + folder.filePath("nobody.sock").toStdString());
  bool is_refused = false;
  QObject::connect(&connection, &Connection::jog_refused, &connection, [&] { is_refused = true; });
  CHECK(wait_until([&] {
    if (!is_refused) connection.jog({{api::Axis::X, 0.1}});
    return is_refused;
  }));
}

}  // namespace cnc::gui::test
