// Conformance of the M codes: one row per form and per error of manual 3.5, 2.11 and the set-up of
// probe and camera, each with its section. Where the manual leaves a choice, docs/canonical.md says
// which was made.
#include <array>
#include <catch2/catch.hpp>

#include "tests/interpreter/conformance.h"
#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

constexpr auto kRows = std::to_array<Row>({
    {"3.5.2", "S1000 M3", "SET_SPINDLE_SPEED(1000.000000); START_SPINDLE_CLOCKWISE()"},
    {"3.5.2", "M4", "START_SPINDLE_COUNTERCLOCKWISE()"},
    {"3.5.2", "M5", "STOP_SPINDLE_TURNING()"},
    {"3.5.3", "T2 M6", "SELECT_TOOL(2); CHANGE_TOOL(2)"},
    {"3.5.4", "M7\nM8", "SET_COOLANT(MIST_ON, FLOOD_OFF); SET_COOLANT(MIST_ON, FLOOD_ON)"},
    {"3.5.4", "M8\nM9", "SET_COOLANT(MIST_OFF, FLOOD_ON); SET_COOLANT(MIST_OFF, FLOOD_OFF)"},
    {"3.5.6", "M90",
     "SELECT_HEAD(SPINDLE_0, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
    {"3.5.6", "M91",
     "SELECT_HEAD(SPINDLE_1, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
    {"3.5.6", "M92",
     "SELECT_HEAD(SPINDLE_2, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
    {"3.5.6", "M93",
     "SELECT_HEAD(SPINDLE_2, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
    {"3.5.6", "M95",
     "SELECT_HEAD(PROBE, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
    {"3.5.6", "M97",
     "SELECT_HEAD(CAMERA, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
    {"3.5.1", "M0", "PROGRAM_STOP()"},
    {"3.5.1", "M1", "OPTIONAL_PROGRAM_STOP()"},
    {"3.5.1", "M60", "PALLET_SHUTTLE()"},
    {"3.5.1", "M2", ""},
    {"3.5.1", "M30", ""},
    {"3.5.5", "M49", "ENABLE_OVERRIDES(FEED_OFF, SPEED_OFF)"},
    {"3.5.5", "M48", "ENABLE_OVERRIDES(FEED_ON, SPEED_ON)"},
    {"3.5.5", "M50 P120", "SET_OVERRIDE(FEED, 1.200000)"},
    {"3.5.5", "M50 P0", "SET_OVERRIDE(FEED, 0.000000)"},
    {"3.5.5", "M50 P-1", "SET_OVERRIDE(FEED, KEEP)"},
    {"3.5.5", "M51 P80", "SET_OVERRIDE(SPEED, 0.800000)"},
    {"3.5.5", "M51 P-1", "SET_OVERRIDE(SPEED, KEEP)"},
    {"3.5.5", "M52", "USE_FEED_OVERRIDE_INPUT(ON)"},
    {"3.5.5", "M52 P1", "USE_FEED_OVERRIDE_INPUT(ON)"},
    {"3.5.5", "M52 P0", "USE_FEED_OVERRIDE_INPUT(OFF)"},
    {"3.5.5", "M53", "USE_FEED_HOLD_INPUT(ON)"},
    {"3.5.5", "M53 P1", "USE_FEED_HOLD_INPUT(ON)"},
    {"3.5.5", "M53 P0", "USE_FEED_HOLD_INPUT(OFF)"},
    {"3.5.7", "M80", "ENABLE_DRIVES(ON)"},
    {"3.5.7", "M81", "ENABLE_DRIVES(OFF)"},
    {"3.5.7", "M84", "SET_SPINDLE_OUTPUT(DIRECTION, ON)"},
    {"3.5.7", "M85", "SET_SPINDLE_OUTPUT(DIRECTION, OFF)"},
    {"3.5.7", "S500 M86", "SET_SPINDLE_SPEED(500.000000); SET_SPINDLE_OUTPUT(PWM, ON)"},
    {"3.5.7", "M87", "SET_SPINDLE_OUTPUT(PWM, OFF)"},
    {"3.5.8", "M54 P1", "SET_OUTPUT(1, ON)"},
    {"3.5.8", "M54 P50", "SET_OUTPUT(50, ON)"},
    {"3.5.8", "M54 E2 Q500", "SET_ANALOG_OUTPUT(2, 0.500000)"},
    {"3.5.8", "M54 E1 Q0", "SET_ANALOG_OUTPUT(1, 0.000000)"},
    {"3.5.8", "M54 E1 Q1000", "SET_ANALOG_OUTPUT(1, 1.000000)"},
    {"3.5.8", "M55 P1", "SET_OUTPUT(1, OFF)"},
    {"3.5.8", "M56 P3", "READ_INPUT(3)"},
    {"3.5.8", "M56 P3 L0 Q5", "READ_INPUT(3)"},
    {"3.5.8", "M56 P3 L0", "READ_INPUT(3)"},
    {"3.5.8", "M56 P3 L1 Q2.5", "READ_INPUT(3, HIGH, 2.500000)"},
    {"3.5.8", "M56 P3 L2 Q30", "READ_INPUT(3, LOW, 30.000000)"},
    {"3.5.8", "M56 E3", "READ_ANALOG_INPUT(3)"},
    {"3.5.8", "M56 P51", "READ_INPUT(51)"},
    {"3.5.8", "M56 P56", "READ_INPUT(56)"},
    {"3.5.8", "M56 P61", "READ_INPUT(61)"},
    {"3.5.8", "M56 P67", "READ_INPUT(67)"},
    {"3.5.9", "M54 P103", "SET_OUTPUT(103, ON)"},
    {"3.5.9", "M55 P208", "SET_OUTPUT(208, OFF)"},
    {"3.5.9", "M56 P208", "READ_INPUT(208)"},
    {"3.5.9", "M54 E103 Q250", "SET_ANALOG_OUTPUT(103, 0.250000)"},
    {"3.5.9", "M56 E999", "READ_ANALOG_INPUT(999)"},
    {"3.5.10", "M26", "CLAMP_AXIS(A)"},
    {"3.5.10", "M26 P1", "CLAMP_AXIS(A, 1)"},
    {"3.5.10", "M27", "UNCLAMP_AXIS(A)"},
    {"3.5.10", "M27 P2", "UNCLAMP_AXIS(A, 2)"},
    {"3.5.10", "M26 P3\nM27", "CLAMP_AXIS(A, 3); UNCLAMP_AXIS(A, 3)"},
    {"3.5.10", "M26 P3\nM27 P3\nM27 P1",
     "CLAMP_AXIS(A, 3); UNCLAMP_AXIS(A, 3); UNCLAMP_AXIS(A, 1)"},
    {"3.5.10", "M26 P3\nM26\nM27", "CLAMP_AXIS(A, 3); CLAMP_AXIS(A, 3); UNCLAMP_AXIS(A, 3)"},
    {"3.3, table 3-6", "M20", "TORCH_HEIGHT_CONTROL(ON)"},
    {"3.3, table 3-6", "M21", "TORCH_HEIGHT_CONTROL(OFF)"},
    {"table 3-6", "M23 Q125.5", "SET_TORCH_HEIGHT(125.500000)"},
    {"table 3-6", "M22 Q100", "SET_TORCH_HEIGHT(100.000000)"},
    {"table 3-6", "M20 M23 Q90", "SET_TORCH_HEIGHT(90.000000); TORCH_HEIGHT_CONTROL(ON)"},
    {"3.5.12", "M100 P1.01", "SCALE_AXIS(A, 1.010000)"},
    {"3.5.12", "M104 S50", "SET_TEMPERATURE(EXTRUDER, 50.000000)"},
    {"3.5.12", "M104 S0", "SET_TEMPERATURE(EXTRUDER, 0.000000)"},
    {"3.5.12", "M109 S200", "SET_TEMPERATURE(EXTRUDER, 200.000000, WAIT)"},
    {"3.5.12", "M140 S60", "SET_TEMPERATURE(BED, 60.000000)"},
    {"3.5.12", "M190 S60", "SET_TEMPERATURE(BED, 60.000000, WAIT)"},
    {"table 3-6", "M140 S60\nM190",
     "SET_TEMPERATURE(BED, 60.000000); SET_TEMPERATURE(BED, 60.000000, WAIT)"},
    {"3.5.12", "M143 S260", "SET_TEMPERATURE_LIMIT(260.000000)"},
    {"table 3-6", "M106 S255", "SET_FAN(1.000000)"},
    {"table 3-6", "M106 S51", "SET_FAN(0.200000)"},  // 51 / 255
    {"table 3-6", "M106", "SET_FAN(1.000000)"},
    {"table 3-6", "M107", "SET_FAN(0.000000)"},
});

void check_commands(const Row& row) {
  INFO(row.rule << ": " << row.program);
  CHECK(commands_of(row.program) == row.expected);
}

void check_refusal(const Row& row) {
  INFO(row.rule << ": " << row.program);
  CHECK(refusal_of(row.program) == row.expected);
}

bool has_line(const Outcome& outcome, const std::string& line) {
  return std::find(outcome.lines.begin(), outcome.lines.end(), line) != outcome.lines.end();
}

}  // namespace

std::span<const Row> cnc::interp::test::m_code_rows() { return kRows; }

TEST_CASE("M codes do what the manual says",
          "[conformance][GCO-9][GCO-10][GCO-11][GCO-12][CRD-4]") {
  check_commands(GENERATE(from_range(kRows)));
}

TEST_CASE("M56 reads into #5399", "[conformance][GCO-10]") {
  // Manual 3.5.8. Nothing is connected here: everything reads low; waiting for high succeeds.
  Bench bench;
  bench.parameters.set(5399, 7);
  REQUIRE_FALSE(bench.run("M56 P3\n#1=#5399\nM56 P3 L1 Q1\n#2=#5399\n").failed);
  CHECK(bench.parameters.get(1) == 0.0);
  CHECK(bench.parameters.get(2) == 1.0);
}

TEST_CASE("Words of M codes that are missing, too many or out of range are refused",
          "[conformance][LNG-10]") {
  check_refusal(GENERATE(values<Row>({
      {"table 3-6", "M22", "word_missing@1"},
      {"table 3-6", "M23", "word_missing@1"},
      {"table 3-6", "M23 Q-1", "word_out_of_range@5"},
      {"table 3-6", "M20 M21", "modal_group_conflict@5"},
      {"3.5.10", "M26 P0", "word_out_of_range@5"},
      {"3.5.10", "M26 P51", "word_out_of_range@5"},
      {"3.5.10: of another brake", "M26 P3\nM27 P1", "axis_clamped@5"},
      {"3.5.10: of another brake", "M26\nM27 P1", "axis_clamped@5"},
      {"3.5.10: a second brake", "M26 P3\nM26 P1", "axis_clamped@5"},
      {"3.3", "M26 M27", "modal_group_conflict@5"},
      {"3.5.5", "M50", "word_missing@1"},
      {"3.5.5", "M51", "word_missing@1"},
      {"3.5.5", "M50 P301", "word_out_of_range@5"},
      {"3.5.5", "M52 P2", "word_out_of_range@5"},
      {"3.5.5", "M53 P-1", "word_out_of_range@5"},
      {"3.3", "M48 M50 P5", "modal_group_conflict@5"},
      {"3.5.8", "M54", "word_missing@1"},
      {"3.5.8", "M54 P0", "word_out_of_range@5"},
      {"3.5.8", "M54 P1.5", "word_out_of_range@5"},
      {"3.5.8", "M54 P-1", "word_out_of_range@5"},
      {"3.5.8", "M54 P61", "word_out_of_range@5"},
      {"3.5.8", "M54 P1 E1", "words_exclude_each_other@8"},
      {"3.5.8", "M54 P1 Q1", "word_unused@8"},
      {"3.5.8", "M54 E1", "word_missing@1"},
      {"3.5.8", "M54 E1 Q-1", "word_out_of_range@8"},
      {"3.5.8", "M54 E1 Q1001", "word_out_of_range@8"},
      {"3.5.8", "M54 E0 Q1", "word_out_of_range@5"},
      {"3.5.8", "M55", "word_missing@1"},
      {"3.5.8", "M55 P60", "word_out_of_range@5"},
      {"3.5.8", "M55 E1", "word_missing@1"},
      {"3.5.8", "M56", "word_missing@1"},
      {"3.5.8", "M56 P57", "word_out_of_range@5"},
      {"3.5.8", "M56 P60", "word_out_of_range@5"},
      {"3.5.8", "M56 P68", "word_out_of_range@5"},
      {"3.5.8", "M56 P1 E1", "words_exclude_each_other@8"},
      {"3.5.8", "M56 P1 L3 Q1", "word_out_of_range@8"},
      {"3.5.8", "M56 P1 L1", "word_missing@1"},
      {"3.5.8", "M56 P1 Q1", "word_missing@1"},
      {"3.5.8", "M56 P1 L1 Q-1", "word_out_of_range@11"},
      {"3.5.8", "M56 E1 L1 Q1", "word_unused@8"},
      {"3.5.8", "M56 E51", "word_out_of_range@5"},
      {"3.5.9", "M54 P100", "word_out_of_range@5"},
      {"3.5.9", "M56 P1001", "word_out_of_range@5"},
      {"3.3", "M54 P1 M55", "modal_group_conflict@8"},
      {"3.5.7", "M80 M81", "modal_group_conflict@5"},
      {"3.5.7", "M84 M85", "modal_group_conflict@5"},
      {"3.5.7", "M86 M87", "modal_group_conflict@5"},
      {"3.5.6", "M90 M91", "modal_group_conflict@5"},
      {"3.5.6", "M91 P2", "word_out_of_range@5"},
      {"3.5.6", "M90 Q1", "word_unused@5"},
      {"probing", "M95 P1 Q1", "words_exclude_each_other@8"},
      {"probing", "M95\nM97 Q1", "head_not_measurable@5"},
      {"3.5.12", "M100", "word_missing@1"},
      {"3.5.12", "M100 P0", "word_out_of_range@6"},
      {"3.5.12", "M104", "word_missing@1"},
      {"3.5.12", "M104 S-1", "word_out_of_range@6"},
      {"3.5.12", "M104 S501", "word_out_of_range@6"},
      {"3.5.12", "M109", "word_missing@1"},
      {"3.5.12", "M190", "word_missing@1"},
      {"3.5.12", "M140", "word_missing@1"},
      {"3.5.12", "M143", "word_missing@1"},
      {"table 3-6", "M106 S256", "word_out_of_range@6"},
      {"3.3", "M104 S1 M140", "modal_group_conflict@9"},
      {"3.3", "M106 S1 M104", "word_claimed_twice@6"},
      {"3.3", "M64 P1", "unknown_m_code@1"},
  })));
}

TEST_CASE("The S of a temperature or fan is no spindle speed", "[conformance][GCO-12]") {
  const Outcome outcome = run("S1000\nM104 S200\nM106 S100\n");
  CHECK(outcome.modal.speed == 1000.0);
  CHECK_FALSE(has_line(outcome, "SET_SPINDLE_SPEED(200.000000)"));
}

TEST_CASE("M1 switches the heaters of a 3D printer off", "[conformance][GCO-12]") {
  Bench bench;
  bench.settings.is_3d_printer = true;
  const Outcome outcome = bench.run("M140 S60\nM1\n");
  CHECK(has_line(outcome, "HEATERS_OFF()"));
  CHECK_FALSE(has_line(outcome, "OPTIONAL_PROGRAM_STOP()"));
  // Nothing is left to wait for.
  CHECK(bench.run("M140 S60\nM1\nM190\n").diagnostic.code == ErrorCode::word_missing);
}

TEST_CASE("Codes of different groups are executed in the order of the documentation",
          "[conformance][GCO-9]") {
  check_commands(GENERATE(values<Row>({
      {"3.7", "M8 M3 S5 M80 M91",
       "SELECT_HEAD(SPINDLE_1, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "SET_SPINDLE_SPEED(5.000000); ENABLE_DRIVES(ON); START_SPINDLE_CLOCKWISE(); "
       "SET_COOLANT(MIST_OFF, FLOOD_ON)"},
      {"3.7", "G0 X1 M54 P2 M21 M60",
       "TORCH_HEIGHT_CONTROL(OFF); SET_OUTPUT(2, ON); STRAIGHT_TRAVERSE(1.000000, 0.000000, "
       "0.000000, "
       "0.000000, 0.000000, 0.000000); PALLET_SHUTTLE()"},
      {"3.7", "M52 M53 M20",
       "USE_FEED_OVERRIDE_INPUT(ON); USE_FEED_HOLD_INPUT(ON); "
       "TORCH_HEIGHT_CONTROL(ON)"},
  })));
}

TEST_CASE("M2 and M30 enable overrides, stop spindle outputs and torch height, and keep the rest",
          "[conformance][GCO-9]") {
  // Manual 3.5.1; what it does not name stays.
  const auto end = GENERATE(as<std::string>{}, "M2", "M30");
  const Outcome outcome = run("M50 P-1\nM86\nM20\nM26\nM91\nM104 S200\n" + end + "\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(has_line(outcome, "ENABLE_OVERRIDES(FEED_ON, SPEED_ON)"));
  CHECK(has_line(outcome, "TORCH_HEIGHT_CONTROL(OFF)"));
  CHECK(has_line(outcome, "STOP_SPINDLE_TURNING()"));
  CHECK(outcome.modal.overrides_enabled());
  CHECK_FALSE(outcome.modal.torch_height);
  CHECK_FALSE(outcome.modal.spindle_pwm_output);
  CHECK(outcome.modal.a_clamped);
  CHECK(outcome.modal.head == Head::spindle_1);
  CHECK(outcome.modal.extruder_temperature == 200.0);
}

TEST_CASE("M60 leaves spindle and coolant running", "[conformance][GCO-9]") {
  CHECK(commands_of("M3\nM8\nM60\n") ==
        "START_SPINDLE_CLOCKWISE(); SET_COOLANT(MIST_OFF, FLOOD_ON); PALLET_SHUTTLE()");
}

TEST_CASE("M5 and a tool change switch off what M84 and M86 switched on", "[conformance][GCO-9]") {
  CHECK_FALSE(run("M84\nM86\nM5\n").modal.spindle_pwm_output);
  CHECK(commands_of("M86\nM6 T1\n") ==
        "SET_SPINDLE_OUTPUT(PWM, ON); SELECT_TOOL(1); STOP_SPINDLE_TURNING(); CHANGE_TOOL(1)");
}

TEST_CASE("While A is clamped no code turns it", "[conformance][STA-8]") {
  // Manual 3.5.10.
  SECTION("refused") {
    check_refusal(GENERATE(values<Row>({
        {"3.5.10", "M26\nG0 A1", "axis_clamped@4"},
        {"3.5.10", "M26\nG1 F100 X1 A1", "axis_clamped@12"},
        {"3.5.10", "M26\nG91 G0 A0.001", "axis_clamped@8"},
        {"3.5.10", "M26\nG2 X1 I0.5 F100 A5", "axis_clamped@17"},
        {"3.5.10", "M26 G0 A1", "axis_clamped@8"},
        {"3.5.10", "M26\nG53 G0 A1", "axis_clamped@8"},
        {"3.5.10", "G0 A1\nM26\nG28", "axis_clamped@0"},
        {"3.5.10", "M26\nhome a", "axis_clamped@6"},
    })));
  }
  SECTION("allowed") {
    CHECK(end_of("M26\nG0 X1\n")[Axis::X] == 1.0);
    CHECK(end_of("G0 A5\nM26\nG0 X1 A5\n")[Axis::X] == 1.0);  // A stays where it is
    CHECK(end_of("M26\nM27 G0 A1\n")[Axis::A] == 1.0);
    CHECK(end_of("M26\nG0 B1\n")[Axis::B] == 1.0);
  }
  SECTION("the sentence says what to do") {
    const Outcome outcome = run("M26\nG0 A90\n");
    CHECK(outcome.diagnostic.sentence ==
          "The A axis is clamped (M26): it cannot turn from 0 to 90.");
    CHECK(outcome.diagnostic.allowed == "M27 on a line before.");
    CHECK(outcome.position[Axis::A] == 0.0);
  }
}

TEST_CASE("A reset opens no brake", "[STA-8]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  const auto run_text = [&](const char* text) {
    interpreter.start(Program::from_text(text, "mdi").value(), interpreter.position());
    Progress progress = interpreter.next();
    while (progress == Progress::command) progress = interpreter.next();
    return progress;
  };
  REQUIRE(run_text("M26 P3\n") == Progress::ended);
  interpreter.reset();
  CHECK(run_text("G0 A1\n") == Progress::failed);
  interpreter.stop();
  CHECK(interpreter.modal().clamp_port == 3);
}

// --- heads ---------------------------------------------------------------------------------------

namespace {

Bench bench_with_heads() {
  Bench bench;
  Position& probe = bench.settings.machine.head_offset[static_cast<std::size_t>(Head::probe)];
  probe[Axis::X] = 50;
  probe[Axis::Z] = -8;
  bench.settings.machine.head_offset[static_cast<std::size_t>(Head::spindle_2)][Axis::Y] = 30;
  return bench;
}

}  // namespace

TEST_CASE("The offset of a head is added to the coordinates", "[conformance][CRD-4]") {
  Bench bench = bench_with_heads();
  // Work X1 is at machine 1 + 50 for the probe, and at 1 again for the first spindle.
  CHECK(bench.run("M95\nG0 X1 Y2 Z3\n").position == (Position{{51, 2, -5, 0, 0, 0}}));
  CHECK(bench.run("M95\nG0 X1\nM90\nG0 X1\n").position[Axis::X] == 1.0);
  CHECK(bench.run("M92\nG0 Y0\n").position[Axis::Y] == 30.0);
  CHECK(bench.run("M93\nG0 Y0\n").position[Axis::Y] == 30.0);
  CHECK(bench.run("M95\nG53 G0 X1\n").position[Axis::X] == 1.0);
}

TEST_CASE("Selecting a head moves nothing and tells its offset", "[conformance][CRD-4]") {
  Bench bench = bench_with_heads();
  const Outcome outcome = bench.run("M95\n");
  CHECK(outcome.position == Position{});
  CHECK(outcome.lines.front() ==
        "SELECT_HEAD(PROBE, 50.000000, 0.000000, -8.000000, 0.000000, 0.000000, 0.000000)");
  CHECK(outcome.modal.active_codes() ==
        "G80 G17 G21 G40 G49 G54 G61 G90 G94 G97 M5 M9 M48 M95 T0 F0 S0");
}

TEST_CASE("P1 takes the head to where the one before it was", "[conformance][CRD-4]") {
  Bench bench = bench_with_heads();
  // Camera set-up: "Use M97 P1 to position the camera at the tooltip position. Use M90 P1 to
  // activate and move the main spindle to the work position."
  const Outcome there = bench.run("G0 X1 Y2 Z3\nM95 P1\n#1=#5001\n#2=#5003\n");
  CHECK(there.position == (Position{{51, 2, -5, 0, 0, 0}}));
  CHECK(bench.parameters.get(1) == 1.0);
  CHECK(bench.parameters.get(2) == 3.0);
  CHECK(bench.run("G0 X1 Y2 Z3\nM95 P1\nM90 P1\n").position == (Position{{1, 2, 3, 0, 0, 0}}));
  // Across before down, up before across.
  const auto moves_of = [&](const char* text) {
    std::vector<std::string> moves;
    for (const std::string& line : bench.run(text).lines) {
      if (line.starts_with("STRAIGHT")) moves.push_back(line);
    }
    return moves;
  };
  const std::string down_first =
      "STRAIGHT_TRAVERSE(50.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)";
  const std::string low =
      "STRAIGHT_TRAVERSE(50.000000, 0.000000, -8.000000, 0.000000, 0.000000, 0.000000)";
  CHECK(moves_of("M95 P1") == std::vector<std::string>{down_first, low});
  CHECK(moves_of("M95 P1\nM90 P1")[2] == down_first);
  CHECK(moves_of("M95 P0").empty());
  CHECK(moves_of("M92\nM92 P1").empty());  // it is there
}

TEST_CASE("Q1 measures the offset of a head by the manual's recipe", "[conformance][CRD-4]") {
  // Zero X Y Z at a point with the first spindle, move the probe to the same point, "M95 Q1". The
  // probe sits 40 to the left and 5 above the tip: the machine goes 40 to the right and 5 down.
  Bench bench;
  const Outcome outcome = bench.run(
      "G0 X10 Y20 Z-30\nG10 L20 P1 X0 Y0 Z0\nG53 G0 X50 Y20 Z-35\nM95 Q1\n"
      "#1=#5001 #2=#5002 #3=#5003 #4=#5391 #5=#5393 #6=#5390\nG0 X1 Z1\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(has_line(outcome,
                 "STORE_HEAD_OFFSET(PROBE, 40.000000, 0.000000, -5.000000, 0.000000, 0.000000, "
                 "0.000000)"));
  for (const int number : {1, 2, 3}) CHECK(bench.parameters.get(number) == 0.0);
  CHECK(bench.parameters.get(4) == 40.0);
  CHECK(bench.parameters.get(5) == -5.0);
  CHECK(bench.parameters.get(6) == 3.0);
  CHECK(outcome.position == (Position{{51, 20, -34, 0, 0, 0}}));
}

TEST_CASE("A measured offset is kept for the next time and through a reset", "[CRD-4]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  const auto run_text = [&](const char* text) {
    interpreter.start(Program::from_text(text, "mdi").value(), interpreter.position());
    while (interpreter.next() == Progress::command) {
    }
  };
  run_text("G0 X40\nM97 Q1\nM90\n");
  CHECK(interpreter.work_position()[Axis::X] == 40.0);
  interpreter.reset();
  CHECK(interpreter.modal().head == Head::spindle_0);
  run_text("M97\n");
  CHECK(interpreter.work_position()[Axis::X] == 0.0);
}

TEST_CASE("A refused line measures no offset", "[CRD-4]") {
  Bench bench;
  CHECK(bench.run("G0 X40\nM95 Q1 G1 X1\n").failed);  // G1 without feed
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  CheckOptions options;
  const auto program = Program::from_text("G0 X40\nM95 Q1 G1 X1\nM95\nG0 X0\n", "test").value();
  Position end;
  options.sink = [&](const Command& command) {
    if (const auto* move = std::get_if<RapidMove>(&command.body)) end = move->end;
  };
  CHECK(check(program, bench.settings, {}, {}, {}, options).errors.size() == 1);
  CHECK(end[Axis::X] == 0.0);
}

TEST_CASE("Another head stops the spindle first, for its outputs are others", "[CRD-4][SPN-1]") {
  CHECK(commands_of("M3\nM91\n") ==
        "START_SPINDLE_CLOCKWISE(); STOP_SPINDLE_TURNING(); "
        "SELECT_HEAD(SPINDLE_1, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)");
  CHECK_THAT(commands_of("M3\nM90\n"), !Catch::Matchers::Contains("STOP_SPINDLE"));
}

TEST_CASE("Zeroing with a head active keeps its offset apart", "[CRD-1][CRD-4]") {
  Bench bench = bench_with_heads();
  const auto zero = GENERATE(as<std::string>{}, "G92 X0", "G10 L20 P1 X0");
  // Machine 70 is X0 for the probe, so X0 is at 70 - 50 for the first spindle.
  CHECK(bench.run("G53 G0 X70\nM95\n" + zero + "\nM90\nG0 X0\n").position[Axis::X] == 20.0);
}
