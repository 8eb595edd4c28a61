// G2 and G3: manual 3.4.3.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

struct Row {
  const char* rule;
  const char* text;
  const char* expected;
};

/// The arcs of `text`.
std::vector<ArcMove> arcs_of(const std::string& text) {
  const auto program = Program::from_text(text, "arcs").value();
  std::vector<ArcMove> arcs;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* arc = std::get_if<ArcMove>(&command.body)) arcs.push_back(*arc);
  };
  const CheckReport report = check(program, {}, {}, {}, {}, options);
  for (const Diagnostic& error : report.errors) UNSCOPED_INFO(error.to_string());
  REQUIRE(report.ok());
  return arcs;
}

}  // namespace

TEST_CASE("Arcs with a centre", "[GCO-2]") {
  const auto row = GENERATE(values<Row>({
      // Manual 3.4.3.2: from (7, 7), centre (10, 11), radius 5.
      {"the manual's helix", "F60 G0 X7 Y7\nG17 G2 x10 y16 i3 j4 z9",
       "ARC_FEED(10.000000, 16.000000, 10.000000, 11.000000, -1, 9.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"counter-clockwise, one offset", "F60 G0 X16\nG3 X13.5 Y-2.5 I-2.5",
       "ARC_FEED(13.500000, -2.500000, 13.500000, 0.000000, 1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"a full circle without end point", "F60\nG2 I5",
       "ARC_FEED(0.000000, 0.000000, 5.000000, 0.000000, -1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"a full circle with its end point", "F60\nG3 X0 Y0 J5",
       "ARC_FEED(0.000000, 0.000000, 0.000000, 5.000000, 1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"in the XZ plane: Z first, X second", "F60\nG18 G2 X10 Z10 I10 K0",
       "ARC_FEED(10.000000, 10.000000, 0.000000, 10.000000, -1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"in the YZ plane", "F60\nG19 G3 Y10 Z10 J10",
       "ARC_FEED(10.000000, 10.000000, 10.000000, 0.000000, 1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"rotary axes turn along", "F60\nG2 X2 I1 A90",
       "ARC_FEED(2.000000, 0.000000, 1.000000, 0.000000, -1, 0.000000, 90.000000, 0.000000, "
       "0.000000)"},
      {"absolute centres", "F60 G0 X10\nG90.1 G2 X30 I20 J0",
       "ARC_FEED(30.000000, 0.000000, 20.000000, 0.000000, -1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"increments do not touch I and J", "F60 G0 X10\nG91 G2 X20 I10",
       "ARC_FEED(30.000000, 0.000000, 20.000000, 0.000000, -1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"inches", "G20\nF1\nG2 X2 I1",
       "ARC_FEED(50.800000, 0.000000, 25.400000, 0.000000, -1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
      {"K0 in the XY plane", "F60\nG2 X2 I1 J0 K0.000",
       "ARC_FEED(2.000000, 0.000000, 1.000000, 0.000000, -1, 0.000000, 0.000000, 0.000000, "
       "0.000000)"},
  }));
  INFO(row.rule);
  CHECK_THAT(commands_of(row.text), Catch::Matchers::EndsWith(row.expected));
}

TEST_CASE("Arcs with a radius turn less than half for R above 0, more for R below 0", "[GCO-2]") {
  // From (0, 0) to (10, 0) with R 10 the centre lies at (5, +-sqrt(100 - 25)).
  const double height = std::sqrt(75.0);
  struct Case {
    const char* text;
    double centre;
    int turns;
  };
  const auto row = GENERATE_COPY(values<Case>({
      {"F1\nG2 X10 R10\n", -height, -1},
      {"F1\nG3 X10 R10\n", height, 1},
      {"F1\nG2 X10 R-10\n", height, -1},
      {"F1\nG3 X10 R-10\n", -height, 1},
      {"F1\nG2 X20 R10\n", 0.0, -1},      // half a circle
      {"F1\nG2 X20 R9.9995\n", 0.0, -1},  // and one that rounding made a little too small
  }));
  INFO(row.text);
  const ArcMove arc = arcs_of(row.text).at(0);
  CHECK(arc.first_centre == Approx(arc.end[Axis::X] / 2).margin(1e-12));
  CHECK(arc.second_centre == Approx(row.centre).margin(1e-9));
  CHECK(arc.turns == row.turns);
}

TEST_CASE("R arcs in all planes keep their radius and their sense", "[GCO-2]") {
  struct Case {
    const char* text;
    Plane plane;
  };
  const auto row = GENERATE(values<Case>({{"F1\nG17 G3 X3 Y4 R7\n", Plane::xy},
                                          {"F1\nG18 G3 Z3 X4 R7\n", Plane::xz},
                                          {"F1\nG19 G3 Y3 Z4 R7\n", Plane::yz}}));
  const ArcMove arc = arcs_of(row.text).at(0);
  CHECK(arc.plane == row.plane);
  // The same words along first and second axis give the same centre in every plane.
  const ArcMove in_xy = arcs_of("F1\nG17 G3 X3 Y4 R7\n").at(0);
  CHECK(arc.first_centre == Approx(in_xy.first_centre));
  CHECK(arc.second_centre == Approx(in_xy.second_centre));
  CHECK(std::hypot(arc.first_centre, arc.second_centre) == Approx(7.0));
}

TEST_CASE("Arcs that cannot be are refused and name the word", "[GCO-2][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"R too small for the end point", "F1\nG2 X10 R4", "arc_radius_too_small@8"},
      {"R with the end at the start", "F1\nG2 X0 R4", "arc_radius_end_is_start@7"},
      {"R without an end point", "F1\nG2 R4", "axis_words_missing@1"},
      {"R with an end point out of the plane", "F1\nG2 Z4 R4", "axis_words_missing@1"},
      {"R 0", "F1\nG2 X1 R0", "arc_radius_zero@7"},
      {"R and I", "F1\nG2 X1 R1 I1", "arc_format_mixed@7"},
      {"neither", "F1\nG2 X1 Y1", "arc_centre_missing@1"},
      {"K in the XY plane", "F1\nG2 X1 I1 K1", "arc_centre_off_plane@10"},
      {"J in the XZ plane", "F1\nG18 G2 X1 I1 J1", "arc_centre_off_plane@14"},
      {"I in the YZ plane", "F1\nG19 G2 Y1 J1 I1", "arc_centre_off_plane@14"},
      {"a centre at the start", "F1\nG2 X0 I0 J0", "arc_radius_zero@1"},
      {"radii that differ by 0.003 mm of 1", "F1\nG2 X2.003 I1", "arc_radius_mismatch@1"},
      {"no words at all", "F1\nG2", "axis_words_missing@1"},
      {"absolute centre with one coordinate", "F1\nG90.1 G2 X2 I1", "word_missing@7"},
      {"no feed", "G2 X2 I1", "feed_not_set@1"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("The radii of an arc may differ by 0.002 mm or 0.1 % of the radius", "[GCO-2]") {
  CHECK(refusal_of("F1\nG2 X2.0019 I1\n").empty());
  CHECK(refusal_of("F1\nG2 X2.0021 I1\n") == "arc_radius_mismatch@1");
  // Radius 1000: 1 mm.
  CHECK(refusal_of("F1\nG2 X2000.9 I1000\n").empty());
  CHECK(refusal_of("F1\nG2 X2001.1 I1000\n") == "arc_radius_mismatch@1");
  // 0.0002 inch are 0.00508 mm: 0.00019 inch more than 2 at radius 0.1 inch pass.
  CHECK(refusal_of("G20\nF1\nG2 X0.20019 I0.1\n").empty());
  CHECK(refusal_of("G20\nF1\nG2 X0.20022 I0.1\n") == "arc_radius_mismatch@1");
}
