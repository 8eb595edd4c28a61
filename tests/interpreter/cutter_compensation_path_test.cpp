// Where the tool goes under cutter compensation: manual 3.4.11, 3.1.2.1 and chapter 5. Expected
// points are computed by hand; a is the length of an entry move, sqrt(d * d - r * r) for a first
// move of length d with a tool of radius r.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/interpreter/tool_path.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

using Kind = PathMove::Kind;

void check_ends(const std::vector<PathMove>& moves, const std::vector<PlanePoint>& expected,
                Plane plane = Plane::xy) {
  const std::vector<PlanePoint> ends = ends_of(moves, plane);
  REQUIRE(ends.size() == expected.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    INFO("move " << i);
    CHECK(ends[i].first == Approx(expected[i].first).margin(1e-9));
    CHECK(ends[i].second == Approx(expected[i].second).margin(1e-9));
  }
}

void check_ends(std::string_view text, const std::vector<PlanePoint>& expected) {
  check_ends(path_of({}, text), expected);
}

Bench lathe(bool diameter_programming) {
  Bench bench;
  bench.settings.diameter_programming = diameter_programming;
  bench.settings.front_tool_post = true;
  return bench;
}

}  // namespace

TEST_CASE("The milling example of 3.4.11.1, outside and inside", "[GCO-4]") {
  const double a = std::sqrt(100.0 - 9.0);
  const auto moves = path_of({},
                             "g0 z3\ng0 x-15 y15\nf500\ng42.1 D6\ng1 x-5\ng2 x0 y10 r5\ng1 z-3\n"
                             "g3 x10 y0 r10\ng1 x70\ng3 x80 y10 r10\ng1 y90\ng3 x70 y100 r10\n"
                             "g1 x10\ng3 x0 y90 r10\ng1 x0 y10\ng40\ng0 z3\ng0 x30 y30\n"
                             "g41.1 d6\ng1 x20\ng3 x10 y20 r10\ng1 z-3\ng3 x20 y10 r10\ng1 x60\n"
                             "g3 x70 y20 r10\ng1 y80\ng3 x60 y90 r10\ng1 x20\ng3 x10 y80 r10\n"
                             "g1 y20\ng40\ng0 z3\nm30\n");
  check_ends(moves, {{0, 0},
                     {-15, 15},
                     // Beside (-5, 15), 3 mm to the right of the tangent to the tool; around it.
                     {-5 - 0.9, 15 - 0.3 * a},
                     {-5, 12},
                     {-3, 10},
                     {-3, 10},
                     {10, -3},
                     {70, -3},
                     {83, 10},
                     {83, 90},
                     {70, 103},
                     {10, 103},
                     {-3, 90},
                     {-3, 10},
                     {-3, 10},
                     {30, 30},
                     {20 + 0.9, 30 - 0.3 * a},
                     {20, 27},
                     {13, 20},
                     {13, 20},
                     {20, 13},
                     {60, 13},
                     {67, 20},
                     {67, 80},
                     {60, 87},
                     {20, 87},
                     {13, 80},
                     {13, 20},
                     {13, 20}});
  CHECK(moves[5].end[Axis::Z] == -3.0);
  CHECK(moves[3].kind == Kind::arc);
  CHECK(moves[3].piece.centre.first == -5.0);
  CHECK(moves[3].piece.turns == 1);
}

TEST_CASE("The contour of table A-1 with the tool 1 in diameter", "[GCO-4]") {
  const double a = std::sqrt(0.75);
  check_ends(
      "F9\nG1 X1 Y5\nG41.1 D1 G1 Y4\nG3 X2 Y3 I1\nG2 X3 Y2 J-1\nG1 Y-1\nG2 X2 Y-2 I-1\n"
      "G1 X-2\nG2 X-2.6 Y-0.2 J1\nG1 X1.4 Y2.8\nG2 X2 Y3 I0.6 J-0.8\nG40\n",
      {{1, 5},
       {1 + 0.5 * a, 4 + 0.25},
       {1.5, 4},
       {2, 3.5},
       {3.5, 2},
       {3.5, -1},
       {2, -2.5},
       {-2, -2.5},
       {-2.9, 0.2},
       {1.1, 3.2},
       {2, 3.5}});
}

TEST_CASE("The simple entry of 5.2: straight to a convex corner", "[GCO-4]") {
  // From B (1.5, 4) to A (3, 3) with r = 0.5: d * d = 3.25, a = sqrt(3). The tool's way has the
  // direction u = ((1.5 a + 0.5) / 3.25, (0.75 - a) / 3.25) and ends 0.5 to the left of A.
  const double a = std::sqrt(3.0);
  const double u = (1.5 * a + 0.5) / 3.25;
  const double v = (0.75 - a) / 3.25;
  check_ends("F9\nG1 X1.5 Y4\nG41.1 D1 G1 X3 Y3\nG1 Y-1\n",
             {{1.5, 4}, {3 - 0.5 * v, 3 + 0.5 * u}, {3.5, 3}, {3.5, -1}});
}

TEST_CASE("A nominal path with an undersized tool runs on the other side", "[GCO-4]") {
  // Table A-2: the tool is 0.03 too small. G41 and the radius -0.015: 0.015 to the right.
  Bench bench;
  REQUIRE(bench.tools.set(7, {.diameter = -0.03, .description = {}}));
  const std::string program =
      "F9\nG1 X1.5 Y5\nG41 D7 G1 Y4\nG3 X2 Y3.5 I0.5\nG2 X3.5 Y2 J-1.5\nG1 Y-1\n"
      "G2 X2 Y-2.5 I-1.5\nG1 X-2\nG2 X-2.9 Y0.2 J1.5\nG1 X1.1 Y3.2\nG2 X2 Y3.5 I0.9 J-1.2\nG40\n";
  const double a = std::sqrt(1 - 0.015 * 0.015);
  check_ends(path_of(bench, program), {{1.5, 5},
                                       {1.5 - 0.015 * a, 4 + 0.015 * 0.015},
                                       {1.485, 4},
                                       {2, 3.485},
                                       {3.485, 2},
                                       {3.485, -1},
                                       {2, -2.485},
                                       {-2, -2.485},
                                       {-2 - 0.6 * 1.485, -1 + 0.8 * 1.485},
                                       {2 - 0.6 * 1.485, 2 + 0.8 * 1.485},
                                       {2, 3.485}});
}

TEST_CASE("A tool of exactly the intended size follows the path as programmed", "[GCO-4]") {
  check_ends("F9 G41 D0\nG1 X1\nY1\nG40\nX5\n", {{1, 0}, {1, 1}, {5, 1}});
}

TEST_CASE("G41 without D uses the tool in the spindle, also after it was changed", "[GCO-4]") {
  Bench bench;
  REQUIRE(bench.tools.set(1, {.diameter = 6, .description = {}}));
  REQUIRE(bench.tools.set(2, {.diameter = 8, .description = {}}));
  // d = 5: the entry move is 4 long, u = (0.8, 0.6).
  CHECK(path_of(bench, "T1 M6\nF9 G41 G1 X5\n")[0].end[Axis::X] == Approx(5 - 0.6 * 3));
  CHECK(path_of(bench, "T2 M6\nF9 G41 D1 G1 X5\n")[0].end[Axis::X] == Approx(5 - 0.6 * 3));
  CHECK(path_of(bench, "T1 M6\nF9 G41\nT2 M6\nG1 X5\n")[0].end[Axis::X] == Approx(5 - 0.6 * 3));
  // d = 5, r = 4: u = (0.6, 0.8).
  CHECK(path_of(bench, "T2 M6\nF9 G41 G1 X5\n")[0].end[Axis::X] == Approx(5 - 0.8 * 4));
}

TEST_CASE("Entry by an arc is tangent to the tool where it stands", "[GCO-4]") {
  // Tool of 2 mm at 0: the auxiliary arc around (0, 10) has the radius 9 for a tool outside of it
  // and 11 inside; it ends 10 mm below and beside its centre.
  const auto outside = path_of({}, "F9 G42.1 D2\nG3 X9 Y10 I0 J10\n");
  check_ends(outside, {{10, 10}});
  const auto inside = path_of({}, "F9 G41.1 D2\nG3 X11 Y10 I0 J10\n");
  check_ends(inside, {{10, 10}});
  // With R the centre follows: 9 from (9, 10), 10 from the tool.
  const auto by_radius = path_of({}, "F9 G42.1 D2\nG3 X9 Y10 R9\n");
  check_ends(by_radius, {{10, 10}});
  CHECK(by_radius[0].piece.centre.second == Approx(10.0));
  CHECK(by_radius[0].piece.turns == 1);
}

TEST_CASE("Inside corners end where the paths cross", "[GCO-4]") {
  // 3 mm to the left, entered along the contour.
  const std::string begin = "G0 X-20 Y3\nF9 G41.1 D6\nG1 X0 Y0\n";
  SECTION("line to line") {
    check_ends(begin + "X20\nY20\nG40\n", {{-20, 3}, {0, 3}, {17, 3}, {17, 20}});
  }
  SECTION("line to an arc") {
    // Around (20, 13) from its lowest point, reached by a line that falls 4 in 3: the path along
    // the line is 3 to its left and crosses the circle of 7 mm within the arc.
    const auto moves = path_of({}, begin + "X20\nG3 X20 Y20 I-5 J10\nG40\n");
    const PlanePoint corner = ends_of(moves)[2];
    CHECK(corner.second == Approx(3.0));
    const double radius = std::sqrt(125.0) - 3;
    CHECK(corner.first == Approx(15 + std::sqrt(radius * radius - 49)));
  }
  SECTION("two outside arcs meet midway") {
    // Half circles of 10 mm around (10, 0) and (30, 0): 13 mm paths cross at x = 20.
    const auto moves =
        path_of({}, "G0 X-3 Y-20\nF9 G41.1 D6\nG1 X0 Y0\nG2 X20 I10\nG2 X40 I10\nG40\n");
    check_ends(moves, {{-3, -20}, {-3, 0}, {20, std::sqrt(69.0)}, {43, 0}});
  }
}

TEST_CASE("Round once stays round once", "[GCO-4]") {
  const std::string begin = "G0 X-20 Y3\nF9 G41.1 D6\nG1 X0 Y0\n";
  const auto full = path_of({}, begin + "G3 J10\nG1 X20\n");
  check_ends(full, {{-20, 3}, {0, 3}, {0, 3}, {20, 3}});
  CHECK(full[2].piece.turns == 1);
  // Almost full, 99.91 mm at its end instead of 100, as rounded programs have it.
  const auto spiral = path_of({}, begin + "G3 X-0.1 Y0.09 J100\n");
  CHECK(spiral.back().piece.turns == 1);
  CHECK(spiral.back().end[Axis::Y] == Approx(3.09).margin(1e-4));
}

TEST_CASE("Commands in an inside corner stay in their place", "[GCO-4]") {
  CHECK(commands_of("G0 X-20 Y3\nF60 G41.1 D6\nG1 X0 Y0\nX20 (along)\nM8\nG4 P1\nZ-1 F120\nY20\n"
                    "G40\nM9\n") ==
        "STRAIGHT_TRAVERSE(-20.000000, 3.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
        "SET_FEED_RATE(1.000000); "
        "STRAIGHT_FEED(0.000000, 3.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
        "COMMENT(\"along\"); "
        "STRAIGHT_FEED(17.000000, 3.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
        "SET_COOLANT(MIST_OFF, FLOOD_ON); "
        "DWELL(1.000000); "
        "SET_FEED_RATE(2.000000); "
        "STRAIGHT_FEED(17.000000, 3.000000, -1.000000, 0.000000, 0.000000, 0.000000); "
        "STRAIGHT_FEED(17.000000, 20.000000, -1.000000, 0.000000, 0.000000, 0.000000); "
        "SET_COOLANT(MIST_OFF, FLOOD_OFF)");
}

TEST_CASE("A refused move leaves the move before it as long as it was", "[GCO-4]") {
  // The square corner would shorten X20 to X17, but A is clamped.
  const auto program =
      Program::from_text("G0 X-20 Y3\nF9 G41.1 D6\nG1 X0 Y0\nM26\nX20\nY20 A5\nX40\nG40\nM30\n",
                         "test.ngc")
          .value();
  std::vector<double> ends;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (const auto* feed = std::get_if<FeedMove>(&command.body)) ends.push_back(feed->end[Axis::X]);
  };
  const CheckReport report = check(program, {}, {}, {}, {}, options);
  REQUIRE(report.errors.size() == 1);
  CHECK(report.errors[0].code == ErrorCode::axis_clamped);
  REQUIRE(ends.size() == 3);
  CHECK(ends[1] == Approx(20.0));
  CHECK(ends[2] == Approx(40.0));
}

TEST_CASE("A search ends beside the contour, where the move before the line begins",
          "[GCO-4][JOB-8]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  const auto program =
      Program::from_text("G0 X-20 Y3\nF9 G41.1 D6\nG1 X0 Y0\nX20\nX40\nG40\nM30\n", "job").value();
  interpreter.start(program, {}, {.mode = RunMode::search, .search_line = 5});
  REQUIRE(interpreter.next() == Progress::found);
  const ResumePoint point = interpreter.resume_point();
  CHECK(point.position[Axis::X] == Approx(0.0).margin(1e-9));
  CHECK(point.position[Axis::Y] == Approx(3.0));
  interpreter.leave_search(point.position);
  for (const double end : {20.0, 40.0}) {
    REQUIRE(interpreter.next() == Progress::command);
    const auto* move = std::get_if<FeedMove>(&interpreter.command().body);
    REQUIRE(move != nullptr);
    CHECK(move->end[Axis::X] == Approx(end));
    CHECK(move->end[Axis::Y] == Approx(3.0));
  }
}

TEST_CASE("A stop on a contour happens where the program stops", "[GCO-4]") {
  const std::string begin = "G0 X-20 Y3\nF60 G41.1 D6\nG1 X0 Y0\n";
  const std::string text = commands_of(begin + "X20\nM0\nX40\nG40\n");
  const std::size_t before = text.find("STRAIGHT_FEED(20.0");
  const std::size_t stop = text.find("PROGRAM_STOP");
  CHECK(before < stop);
  CHECK(stop < text.find("STRAIGHT_FEED(40.0"));
  CHECK(refusal_of(begin + "X20\nM0\nY20\n") == "compensation_inside_corner@1");
  CHECK(refusal_of(begin + "X20\nmsg \"half way\"\nY20\n") == "compensation_inside_corner@1");
  CHECK(refusal_of(begin + "X20\nM0\nY-20\n").empty());
}

TEST_CASE("A contour goes on in the next program where the tool still stands", "[GCO-4]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  const auto type = [&](const char* text, const Position& at) {
    interpreter.start(Program::from_text(text, "line").value(), at);
    for (;;) {
      const Progress progress = interpreter.next();
      if (progress != Progress::command) return progress;
    }
  };
  CHECK(type("G0 X-20 Y3\nF9 G41.1 D6\nG1 X0 Y0\n", {}) == Progress::ended);
  CHECK(interpreter.position()[Axis::Y] == Approx(3.0));
  CHECK(type("X20\n", interpreter.position()) == Progress::ended);
  CHECK(interpreter.position()[Axis::X] == Approx(20.0));
  CHECK(interpreter.position()[Axis::Y] == Approx(3.0));
  // Jogged away to (0, 10), the next line is an entry move: d = 5, u = (0.8, 0.6) from there.
  Position jogged;
  jogged[Axis::Y] = 10;
  CHECK(type("X5 Y10\n", jogged) == Progress::ended);
  CHECK(interpreter.position()[Axis::X] == Approx(4 * 0.8));
  CHECK(interpreter.position()[Axis::Y] == Approx(10 + 4 * 0.6));
}

TEST_CASE("Rapids go around outside corners without cutting them", "[GCO-4]") {
  const std::string begin = "G0 X-20 Y3\nG41.1 D6\nX0 Y0\n";
  // Square: over the meeting point of the two paths. Back on itself: two such points.
  check_ends(begin + "Y-20\n", {{-20, 3}, {0, 3}, {3, 3}, {3, -20}});
  check_ends(begin + "X-10\n", {{-20, 3}, {0, 3}, {3, 3}, {3, -3}, {-10, -3}});
}

TEST_CASE("Z and rotary axes go along with the compensated move", "[GCO-4]") {
  const auto moves =
      path_of({}, "G0 X-20 Y3\nF9 G41.1 D6\nG1 X0 Y0 Z1\nX20 Z2 A90\nG3 Y20 J10 Z5\n");
  REQUIRE(moves.size() == 4);
  CHECK(moves[2].end[Axis::Z] == 2.0);
  CHECK(moves[2].end[Axis::A] == 90.0);
  CHECK(moves[3].end[Axis::Z] == 5.0);
  CHECK(moves[3].end[Axis::Y] == Approx(17.0));
}

TEST_CASE("In inverse time a corner's arc shares the time of its move", "[GCO-4]") {
  // F6: 10 s for 3 pi / 2 mm of arc and 20 mm of line.
  const double arc = 1.5 * M_PI;
  const auto outcome = run("G0 X-20 Y3\nG41.1 D6\nG93\nG1 X0 Y0 F6\nG1 Y-20 F6\n");
  REQUIRE_FALSE(outcome.failed);
  std::vector<double> rates;
  for (const std::string& line : outcome.lines) {
    if (line.starts_with("SET_FEED_RATE(")) rates.push_back(std::stod(line.substr(14)));
  }
  REQUIRE(rates.size() == 4);
  CHECK(rates[2] == Approx(0.1 * (arc + 20) / arc).margin(1e-6));
  CHECK(rates[3] == Approx(0.1 * (arc + 20) / 20).margin(1e-6));
}

TEST_CASE("Parameters give the programmed point, G40 the tool's", "[GCO-4]") {
  const std::string begin = "G0 X-20 Y3\nF9 G41.1 D6\nG1 X0 Y0\n";
  const auto text = commands_of(begin + "logmsg #5001 \"/\" #5002\nG91\nX20\nG40\nY7\n");
  CHECK(text.find("LOG(\"0/0\")") != std::string::npos);
  check_ends(begin + "G91\nX20\nG40\nY7\n", {{-20, 3}, {0, 3}, {20, 3}, {20, 10}});
}

TEST_CASE("The tool's radius is true under rotation and scaling", "[GCO-4][CRD-2]") {
  // Scaled by 2 the contour is 40 long, the tool still 3 mm beside it; turned by 90 degrees left
  // is -X.
  check_ends("G51 P2\nG0 X-10 Y1.5\nF9 G41.1 D6\nG1 X0 Y0\nX20\nY20\n",
             {{-20, 3}, {0, 3}, {37, 3}, {37, 40}});
  check_ends("G68 R90\nG0 X-20 Y3\nF9 G41.1 D6\nG1 X0 Y0\nX20\nY20\n",
             {{-3, -20}, {-3, 0}, {-3, 17}, {-20, 17}});
}

TEST_CASE("Inches: D of G41.1 is in the program's unit, D of G41 in the tool table's", "[GCO-4]") {
  Bench bench;
  REQUIRE(bench.tools.set(1, {.diameter = 6, .description = {}}));
  const double r = 0.125 * 25.4;
  check_ends(path_of(bench, "G20 G0 X-1 Y0.125\nF9 G41.1 D0.25\nG1 X0 Y0\n"), {{-25.4, r}, {0, r}});
  CHECK(path_of(bench, "G20 G0 X-1\nF9 G41 D1\nG1 X0 Y0\n")[1].end[Axis::X] ==
        Approx(-3.0 * 3.0 / 25.4));
}

TEST_CASE("The turning examples of 3.4.11.2 give one path", "[GCO-4][CFG-17]") {
  // As on the manual's pictures: G18, X towards the operator. r = 2.5; points are (Z, X) with X as
  // a radius. Entry: d = 10.
  const double a = std::sqrt(100 - 6.25);
  const std::vector<PlanePoint> expected{{20, -10},   {10 + 2.5 * 0.25, -10 + 0.25 * a},
                                         {10, -7.5},  {2.5, 0},
                                         {2.5, 10},   {-10, 22.5},
                                         {-20, 22.5}, {-27.5, 30}};
  struct Example {
    bool diameters;
    const char* text;
  };
  const auto example = GENERATE(values<Example>({
      {true,
       "g0 x-20 z20\ng41.1 d5\ng1 x-20 z10\ng3 x0 z0 r10\ng1 x20\ng2 x40 z-10 r10\n"
       "g1 z-20\ng3 x60 z-30 r10\ng40\nm30\n"},
      {false,
       "g0 x-10 z20\ng41.1 d5\ng1 x-10 z10\ng3 x0 z0 r10\ng1 x10\ng2 x20 z-10 r10\n"
       "g1 z-20\ng3 x30 z-30 r10\ng40\nm30\n"},
      {true,
       "g0 x-20 z20\ng41.1 d5\ng1 x-20 z10\ng3 x0 z0 i10 k0\ng1 x20\ng2 x40 z-10 i0 k-10\n"
       "g1 z-20\ng3 x60 z-30 i10 k0\ng40\nm30\n"},
      {false,
       "g0 x-10 z20\ng41.1 d5\ng1 x-10 z10\ng3 x0 z0 i10 k0\ng1 x10\ng2 x20 z-10 i0 k-10\n"
       "g1 z-20\ng3 x30 z-30 i10 k0\ng40\nm30\n"},
  }));
  INFO(example.text);
  check_ends(path_of(lathe(example.diameters), std::string("g18 f9\n") + example.text, Plane::xz),
             expected, Plane::xz);
}

TEST_CASE("A turning tool's orientation moves its controlled point", "[GCO-4]") {
  // The nose, r = 1, passes along X10 on the outside: its centre ends at (X11, Z-10). Orientation 2
  // lies one radius towards -X and -Z of it (manual 3.1.2.1).
  struct Tip {
    std::int32_t orientation;
    double x;
    double z;
  };
  const auto tip = GENERATE(values<Tip>({{1, -1, 1},
                                         {2, -1, -1},
                                         {3, 1, -1},
                                         {4, 1, 1},
                                         {5, 0, 1},
                                         {6, -1, 0},
                                         {7, 0, -1},
                                         {8, 1, 0},
                                         {9, 0, 0}}));
  INFO("orientation " << tip.orientation);
  Bench bench;
  REQUIRE(bench.tools.set(1, {.diameter = 2, .orientation = tip.orientation, .description = {}}));
  const std::string program = "G18 F9\nG0 X20 Z20\nG42 D1\nG1 X10 Z0\nZ-10\nG3 X5 Z-15 R5\nG40\n";
  const auto moves = path_of(bench, program, Plane::xz);
  const PathMove& along = moves[moves.size() - 2];
  CHECK(along.end[Axis::X] == Approx(11 + tip.x));
  CHECK(along.end[Axis::Z] == Approx(-10 + tip.z));
  // The arc's centre moves along with the point that is controlled.
  CHECK(moves.back().piece.centre.second == Approx(5 + tip.x));
  CHECK(moves.back().piece.centre.first == Approx(-10 + tip.z));
  CHECK(moves.back().end[Axis::Z] == Approx(-16 + tip.z));
}
