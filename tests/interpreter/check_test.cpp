// Checking whole programs.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <random>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

CheckReport check_text(const std::string& text, const CheckOptions& options = {}) {
  return check(Program::from_text(text, "part.ngc").value(), {}, {}, {}, {}, options);
}

}  // namespace

TEST_CASE("A check lists every wrong line and goes on behind it", "[JOB-2][LNG-10]") {
  const CheckReport report = check_text("G0 X1\nG0 Q1\nG77\nG0 X9\n#1=[1/0]\nM30\n");
  REQUIRE(report.errors.size() == 3);
  CHECK(report.errors[0].line == 2);
  CHECK(report.errors[1].line == 3);
  CHECK(report.errors[2].line == 5);
  CHECK(report.complete);
  CHECK_FALSE(report.ok());
  CHECK(report.motion.highest[Axis::X] == 9.0);
  CHECK(report.line_count == 6);
}

TEST_CASE("A check in a dialect that wants M30 comes to its end without one", "[JOB-2][LNG-11]") {
  InterpreterSettings settings;
  settings.dialect = DialectId::pscnc;
  const auto program = Program::from_text("G00 X1\nM77\n", "part.ngc").value();
  const CheckReport report = check(program, settings, {}, {}, {});
  REQUIRE(report.errors.size() == 2);
  CHECK(report.errors[1].code == ErrorCode::no_program_end);
  CHECK(report.complete);
}

TEST_CASE("A wrong line in a loop is listed once, and the list is bounded", "[JOB-2]") {
  CHECK(check_text("while [#1 < 50]\nG77\n#1=[#1+1]\nendwhile\nM30\n").errors.size() == 1);
  std::string text;
  for (int line = 0; line < 50; ++line) text += "G77\n";
  CheckOptions options;
  options.max_errors = 7;
  const CheckReport report = check_text(text, options);
  CHECK(report.errors.size() == 7);
  CHECK_FALSE(report.complete);
}

TEST_CASE("A check tells one error per cause: a refused line still sets modes, feed and position",
          "[JOB-2]") {
  struct Row {
    const char* text;
    std::vector<std::uint32_t> lines;  ///< of the errors
  };
  const Row row = GENERATE(values<Row>({
      {"G1 X1\nX2\nX3\nG2 X5 I1\nM30\n", {1}},              // no F anywhere
      {"G1 X1\nX2 F100\nG93\nG94\nX3\nX4\nM30\n", {1, 5}},  // missing once more
      {"G1 X1 F100 Q1\nX2\nX3\nM30\n", {1}},                // G1 and F of the line hold
      {"G0 X0 Q1\nX1\nM30\n", {1}},                         // G0 instead of G80
      {"G91 G1 Q1 F9\nX1\nX1\nG90 G2 X4 I1\nM30\n", {1}},   // G91 of it
      {"G0 X10 Y0 Q1\nG2 X0 I-5 F9\nM30\n", {1}},           // the arc begins at its end
      {"G0 X10 Y0 !\nG2 X0 I-5 F9\nM30\n", {1}},            // as far as it could be read
      {"G1 X[1/0] F100\nX2\nM30\n", {1}},                   // as far as it could be computed
      {"G2 X10 I3 F100\nG2 X0 I-5\nM30\n", {1}},            // the arc behind a wrong arc
      {"X1\nX2\nG0 X3\nM30\n", {1, 2}},                     // nobody knows what these should be
  }));
  INFO(row.text);
  std::vector<std::uint32_t> lines;
  for (const Diagnostic& error : check_text(row.text).errors) lines.push_back(error.line);
  CHECK(lines == row.lines);
}

TEST_CASE("A check gives a refused line no commands", "[JOB-2]") {
  CheckOptions options;
  std::string text;
  options.sink = [&](const Command& command) { text += interp::text_of(command) + "\n"; };
  CHECK(check_text("G0 X1\nG1 X2 F60 Q1\nX3\n", options).errors.size() == 1);
  CHECK(text ==
        "STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)\n"
        "STRAIGHT_FEED(3.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)\n"
        "PROGRAM_END()\n");
}

TEST_CASE("Only lines of loops and subs count for the limit of a check", "[JOB-2]") {
  CheckOptions options;
  options.max_loop_lines = 100;
  std::string plain;
  std::string calls = "sub a\nG0 X1\nG0 X2\nendsub\n";
  for (int line = 0; line < 1000; ++line) {
    plain += "G0 X1\n";
    calls += "gosub a\n";
  }
  CHECK(check_text(plain, options).complete);
  CHECK(check_text(calls, options).complete);  // each gosub is a new line
  CHECK(check_text("while [#1 < 24]\n#1 = [#1 + 1]\nG0 X#1\nendwhile\n", options).complete);
  CHECK_FALSE(check_text("while [#1 < 30]\n#1 = [#1 + 1]\nG0 X#1\nendwhile\n", options).complete);
}

TEST_CASE("A check tells how far it has come", "[JOB-2]") {
  CheckOptions options;
  std::vector<CheckProgress> told;
  options.progress = [&](const CheckProgress& progress) { told.push_back(progress); };
  std::string text;
  for (int line = 0; line < 50'000; ++line) text += "G0 X1\n";
  REQUIRE(check_text(text, options).complete);
  REQUIRE(told.size() >= 5);
  CHECK(std::ranges::is_sorted(told, {}, &CheckProgress::line));
  CHECK(told.back().line > 40'000);
  CHECK(told.back().lines_since_new == 0);
}

TEST_CASE("A check ends although the program does not", "[JOB-2]") {
  CheckOptions options;
  options.max_loop_lines = 10'000;
  const CheckReport report = check_text("while [1]\nG0 X[1-#5001]\nendwhile\n", options);
  CHECK_FALSE(report.complete);
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0].code == ErrorCode::check_incomplete);
  CHECK(report.warnings[0].allowed.find("--max-loop-lines") != std::string::npos);

  const std::atomic<bool> cancel = true;
  options.cancel = &cancel;
  CHECK(check_text("G0 X1\n", options).cancelled);
}

TEST_CASE("A program without M2 or M30 is noted", "[JOB-2]") {
  const CheckReport report = check_text("G0 X1\nG0 X2\n");
  CHECK(report.ok());
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0].code == ErrorCode::no_program_end);
  CHECK(report.warnings[0].severity == Severity::warning);
  CHECK(check_text("G0 X1\nM30\n").warnings.empty());
}

TEST_CASE("The extents hold arcs exactly", "[JOB-2]") {
  struct Row {
    const char* text;
    double low_x, high_x, low_y, high_y;
  };
  const auto row = GENERATE(values<Row>({
      // A quarter from (10, 0) counter-clockwise around the origin touches nothing beyond its ends.
      {"G0 X10\nF1\nG3 X0 Y10 I-10\nM2\n", 0, 10, 0, 10},
      // Three quarters the other way pass (0, -10) and (-10, 0).
      {"G0 X10\nF1\nG2 X0 Y10 I-10\nM2\n", -10, 10, -10, 10},
      {"F1\nG2 I5\nM2\n", 0, 10, -5, 5},
      {"F1\nG3 J-5\nM2\n", -5, 5, -10, 0},
      {"F1\nG2 X10 I5\nM2\n", 0, 10, 0, 5},
      {"F1\nG3 X10 I5\nM2\n", 0, 10, -5, 0},
  }));
  INFO(row.text);
  const CheckReport report = check_text(row.text);
  REQUIRE(report.ok());
  CHECK(report.motion.lowest[Axis::X] == Approx(row.low_x).margin(1e-9));
  CHECK(report.motion.highest[Axis::X] == Approx(row.high_x).margin(1e-9));
  CHECK(report.motion.lowest[Axis::Y] == Approx(row.low_y).margin(1e-9));
  CHECK(report.motion.highest[Axis::Y] == Approx(row.high_y).margin(1e-9));
}

TEST_CASE("The extents of random arcs are those of many points on them", "[JOB-2]") {
  constexpr int kPoints = 2000;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any_radius(1.0, 20.0);
  std::uniform_real_distribution<double> any_angle(0.0, 6.28);
  std::uniform_real_distribution<double> any_sweep(-6.2, 6.2);
  for (int arc = 0; arc < 300; ++arc) {
    const double radius = any_radius(random);
    const double begin = any_angle(random);
    const double sweep = any_sweep(random);
    const auto x = [&](double part) { return radius * std::cos(begin + part * sweep); };
    const auto y = [&](double part) { return radius * std::sin(begin + part * sweep); };
    const CheckReport report =
        check_text(fmt::format("G0 X{:.9f} Y{:.9f}\nG90.1 F1 G{} X{:.9f} Y{:.9f} I0 J0\nM2\n", x(0),
                               y(0), sweep < 0.0 ? 2 : 3, x(1), y(1)));
    REQUIRE(report.ok());
    double right = x(0);
    double bottom = y(0);
    for (int i = 1; i <= kPoints; ++i) {
      right = std::max(right, x(static_cast<double>(i) / kPoints));
      bottom = std::min(bottom, y(static_cast<double>(i) / kPoints));
    }
    // Between two of the points the arc rises by at most R (1 - cos(sweep / points / 2)) < 0.00003.
    CHECK(report.cutting.highest[Axis::X] == Approx(right).epsilon(0).margin(0.00003));
    CHECK(report.cutting.lowest[Axis::Y] == Approx(bottom).epsilon(0).margin(0.00003));
  }
}

TEST_CASE("Cutting extents leave rapids out, and are machine coordinates", "[JOB-2]") {
  const CheckReport report = check_text("G92 X-100\nG0 X0 Z50\nG1 X10 F100\nG0 X-500\nM2\n");
  REQUIRE(report.ok());
  CHECK(report.cutting.lowest[Axis::X] == 100.0);
  CHECK(report.cutting.highest[Axis::X] == 110.0);
  CHECK(report.motion.lowest[Axis::X] == -400.0);
  CHECK(check_text("G0 X1\nM2\n").cutting.empty);
}

TEST_CASE("A check does not touch the machine's parameters", "[JOB-2]") {
  config::ParameterStore parameters;
  const config::ParameterStore before = parameters;
  const auto program = Program::from_text("#1=5\nG10 L2 P1 X7\nG55\nM2\n", "p").value();
  CHECK(check(program, {}, parameters, {}, {}).ok());
  CHECK(parameters == before);
}
