// Conformance of the parameters: the table of manual 3.1.1, row by row: what a number reads, and
// whether a program can write it.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

/// A machine on which every row of the table has a value of its own.
Bench furnished_bench() {
  Bench bench;
  MachineFacts& facts = bench.settings.machine;
  facts.negative_limit = Position{{-1, -2, -3, -4, -5, -6}};
  facts.positive_limit = Position{{101, 102, 103, 104, 105, 106}};
  facts.home_position = Position{{11, 12, 13, 14, 15, 16}};
  facts.tool_change_area_low = Position{{21, 22, 23, 0, 0, 0}};
  facts.tool_change_area_high = Position{{31, 32, 33, 0, 0, 0}};
  facts.kinematics = 2;
  facts.simulation = true;
  facts.max_speed = {24000, 18000, 6000};
  facts.head_offset[static_cast<std::size_t>(Head::spindle_1)] = Position{{41, 42, 43, 0, 0, 0}};
  static_cast<void>(bench.tools.set(
      2, {.length = 40, .x_offset = 3, .diameter = 6, .orientation = 4, .description = {}}));
  static_cast<void>(bench.tools.set(
      99, {.length = 9, .x_offset = 8, .diameter = 7, .orientation = 5, .description = {}}));
  bench.parameters.set_six(5161, Position{{1, 2, 3, 4, 5, 6}});
  bench.parameters.set_six(5181, Position{{7, 8, 9, 10, 11, 12}});
  bench.parameters.set_six(5211, Position{{13, 14, 15, 16, 17, 18}});
  for (int system = 1; system <= config::kWorkSystemCount; ++system) {
    bench.parameters.set_work_offset(system, Position{{100.0 * system, 2, 3, 4, 5, 6}});
  }
  return bench;
}

/// What `expression` reads behind `program`.
double value_of(Bench& bench, const std::string& program, const std::string& expression) {
  const Outcome outcome = bench.run(program + "#1=" + expression + "\n");
  UNSCOPED_INFO(outcome.diagnostic.sentence);
  REQUIRE_FALSE(outcome.failed);
  return bench.parameters.get(1);
}

/// "error: what would be right" of a refused line.
std::string answer_to(Bench& bench, const std::string& program) {
  const Outcome outcome = bench.run(program);
  if (!outcome.failed) return {};
  return std::string(error_info(outcome.diagnostic.code).name) + ": " + outcome.diagnostic.allowed;
}

}  // namespace

TEST_CASE("Every row of the parameter table reads what it says", "[conformance][LNG-1]") {
  struct Row {
    const char* rule;
    const char* number;
    double expected;
  };
  const auto row = GENERATE(values<Row>({
      {"3.1.1 position X", "#5001", 7},
      {"3.1.1 position C", "#5006", 12},
      {"3.1.1 actual tool", "#5008", 2},
      {"3.1.1 actual tool radius: half of 6", "#5009", 3},
      {"3.1.1 actual tool Z offset", "#5010", 40},
      {"3.1.1 actual tool X offset", "#5012", 3},
      {"3.1.1 actual G43 Z offset", "#5013", 40},
      {"3.1.1 actual G43 X offset", "#5014", 3},
      {"3.1.1 machine position X: 7 + G54 100 + tool 3", "#5071", 110},
      {"3.1.1 machine position Z: 9 + G54 3 + tool 40", "#5073", 52},
      {"3.1.1 machine position C: 12 + G54 6", "#5076", 18},
      {"3.1.1 negative limits", "#5101", -1},
      {"3.1.1 negative limits", "#5106", -6},
      {"3.1.1 positive limits", "#5111", 101},
      {"3.1.1 positive limits", "#5116", 106},
      {"3.1.1 home", "#5121", 11},
      {"3.1.1 home", "#5126", 16},
      {"3.1.1 TCA negative", "#5131", 21},
      {"3.1.1 TCA negative", "#5133", 23},
      {"3.1.1 TCA positive", "#5141", 31},
      {"3.1.1 TCA positive", "#5143", 33},
      {"3.1.1 active kinematics", "#5150", 2},
      {"3.1.1 G28 home", "#5161", 1},
      {"3.1.1 G28 home", "#5166", 6},
      {"3.1.1 G30 home", "#5181", 7},
      {"3.1.1 G30 home", "#5186", 12},
      {"3.1.1 G92 offset", "#5211", 13},
      {"3.1.1 G92 offset", "#5216", 18},
      {"3.1.1 active system", "#5220", 1},
      {"3.1.1 system 1", "#5221", 100},
      {"3.1.1 system 2", "#5241", 200},
      {"3.1.1 system 3", "#5261", 300},
      {"3.1.1 system 4", "#5281", 400},
      {"3.1.1 system 5", "#5301", 500},
      {"3.1.1 system 6", "#5321", 600},
      {"3.1.1 system 7", "#5341", 700},
      {"3.1.1 system 8", "#5361", 800},
      {"3.1.1 system 9", "#5381", 900},
      {"3.1.1 system 9", "#5386", 6},
      {"3.1.1 simulation", "#5380", 1},
      {"3.1.1 spindle selection", "#5390", 0},
      {"3.1.1 alternate offset of M90", "#5391", 0},
      {"3.1.1 highest speed M90", "#5394", 24000},
      {"3.1.1 highest speed M91", "#5395", 18000},
      {"3.1.1 highest speed M92", "#5396", 6000},
      {"3.1.1 running", "#5397", 0},
      {"3.1.1 tool 2 length", "#5402", 40},
      {"3.1.1 tool 99 length", "#5499", 9},
      {"3.1.1 tool 2 diameter", "#5502", 6},
      {"3.1.1 tool 99 diameter", "#5599", 7},
      {"3.1.1 tool 2 X offset", "#5602", 3},
      {"3.1.1 tool 99 X offset", "#5699", 8},
      {"3.1.1 tool 2 orientation", "#5702", 4},
      {"3.1.1 tool 99 orientation", "#5799", 5},
      {"3.1.1 an empty tool", "#5401", 0},
      {"macros read #[5400 + #5008] with no tool", "#[5400+0]", 0},
      {"macros read #[5500 + #5008] with no tool", "#[5500+0]", 0},
  }));
  INFO(row.rule << ": " << row.number);
  Bench bench = furnished_bench();
  CHECK(value_of(bench, "M6 T2\nG43\nG0 X7 Y8 Z9 A10 B11 C12\n", row.number) ==
        Approx(row.expected));
}

TEST_CASE("#5390 and #5391 to #5393 are those of the active head", "[conformance][LNG-1][CRD-4]") {
  struct Row {
    const char* head;
    const char* number;
    double expected;
  };
  const auto row = GENERATE(values<Row>({{"M91\n", "#5390", 1},
                                         {"M91\n", "#5391", 41},
                                         {"M91\n", "#5392", 42},
                                         {"M91\n", "#5393", 43},
                                         {"M91\nM90\n", "#5393", 0},
                                         {"M92\n", "#5390", 2},
                                         {"M95\n", "#5390", 3},
                                         {"M97\n", "#5390", 4}}));
  INFO(row.head << row.number);
  Bench bench = furnished_bench();
  CHECK(value_of(bench, row.head, row.number) == row.expected);
}

TEST_CASE("#5397 tells rendering from running", "[conformance][LNG-1]") {
  Bench bench;
  std::string seen;
  CheckOptions options;
  options.sink = [&](const Command& command) { seen += text_of(command); };
  const auto program = Program::from_text("if [#5397 == 1]\nmsg \"render\"\nendif\n", "t").value();
  static_cast<void>(check(program, {}, {}, {}, {}, options));
  CHECK(seen == "MESSAGE(\"render\")PROGRAM_END()");
  CHECK(value_of(bench, "", "#5397") == 0.0);
}

TEST_CASE("Live parameters wait for the machine", "[conformance][LNG-1]") {
  const auto number = GENERATE(as<std::string>{}, "5068", "5069", "5070", "5151");
  const Outcome outcome = run("#1=#" + number + "\n");
  CHECK(outcome.lines == std::vector<std::string>{"SYNCHRONISE()", "PROGRAM_END()"});
}

TEST_CASE("A program can write what is its own", "[conformance][LNG-1]") {
  const auto number =
      GENERATE(1, 26, 3999, 4000, 4999, 5011, 5015, 5036, 5050, 5161, 5166, 5181, 5186, 5211, 5216,
               5221, 5226, 5230, 5241, 5261, 5281, 5301, 5321, 5341, 5361, 5370, 5381, 5386, 5398,
               5399, 5401, 5499, 5501, 5599, 5601, 5699, 5701, 5799);
  Bench bench;
  CHECK(value_of(bench, fmt::format("#{}=5\n", number), fmt::format("#{}", number)) == 5.0);
}

TEST_CASE("What a program cannot write is refused with what to do instead",
          "[conformance][LNG-1]") {
  struct Row {
    const char* numbers;
    const char* instead;
  };
  const auto row = GENERATE(values<Row>({
      {"5001", "Moves change the position; G92 or G10 L20 give it other coordinates."},
      {"5006", "Moves change the position; G92 or G10 L20 give it other coordinates."},
      {"5008", "M6 changes the tool."},
      {"5009", "#5401 to #5799 change the data of a tool."},
      {"5010", "#5401 to #5799 change the data of a tool."},
      {"5012", "#5401 to #5799 change the data of a tool."},
      {"5013", "G43, G43.1 and G49 change the tool length in force."},
      {"5014", "G43, G43.1 and G49 change the tool length in force."},
      {"5051", "G38.2 writes it; #1 to #4999 are free."},
      {"5066", "G38.2 writes it; #1 to #4999 are free."},
      {"5067", "G38.2 writes it; #1 to #4999 are free."},
      {"5068", "The machine measures it; #1 to #4999 are free."},
      {"5070", "The machine measures it; #1 to #4999 are free."},
      {"5071", "Moves change the position; G92 or G10 L20 give it other coordinates."},
      {"5081", "G38.2 writes it; #1 to #4999 are free."},
      {"5101", "The machine's set-up says it; #1 to #4999 are free."},
      {"5116", "The machine's set-up says it; #1 to #4999 are free."},
      {"5121", "The machine's set-up says it; #1 to #4999 are free."},
      {"5131", "The machine's set-up says it; #1 to #4999 are free."},
      {"5143", "The machine's set-up says it; #1 to #4999 are free."},
      {"5150", "The machine's set-up says it; #1 to #4999 are free."},
      {"5151", "ZHC ON and ZHC OFF switch the height map."},
      {"5380", "The machine's set-up says it; #1 to #4999 are free."},
      {"5390", "M90 to M97 select the head, with Q1 they measure its offset."},
      {"5393", "M90 to M97 select the head, with Q1 they measure its offset."},
      {"5394", "The machine's set-up says it; #1 to #4999 are free."},
      {"5397", "Checking and running set it; #1 to #4999 are free."},
      {"5400", "#5401 to #5499 for the tools 1 to 99."},
      {"5500", "#5501 to #5599 for the tools 1 to 99."},
      {"5600", "#5601 to #5699 for the tools 1 to 99."},
      {"5700", "#5701 to #5799 for the tools 1 to 99."},
  }));
  Bench bench;
  const std::string number = row.numbers;
  CHECK(answer_to(bench, "#" + number + "=1\n") ==
        std::string("parameter_read_only: ") + row.instead);
  CHECK(answer_to(bench, "#[" + number + "]=1\n") ==
        std::string("parameter_read_only: ") + row.instead);
}

TEST_CASE("Values that a parameter cannot have are refused before the line does anything",
          "[conformance][LNG-1]") {
  struct Row {
    const char* rule;
    const char* setting;
    const char* allowed;
  };
  const auto row = GENERATE(values<Row>({
      {"3.1.2 a whole number between one and nine", "#5220=0",
       "A whole number from 1 (G54) to 9 (G59.3)."},
      {"3.1.2", "#5220=10", "A whole number from 1 (G54) to 9 (G59.3)."},
      {"3.1.2", "#5220=2.5", "A whole number from 1 (G54) to 9 (G59.3)."},
      {"3.1.2", "#5220=-1", "A whole number from 1 (G54) to 9 (G59.3)."},
      {"2.6 length", "#5403=10001", "-10000 to 10000 mm."},
      {"2.6 length", "#5403=-10001", "-10000 to 10000 mm."},
      {"2.6 diameter", "#5503=-1001", "-1000 to 1000 mm."},
      {"2.6 diameter", "#5503=1001", "-1000 to 1000 mm."},
      {"2.6 X offset", "#5603=10001", "-10000 to 10000 mm."},
      {"3.1.2.1 orientation", "#5703=0", "A whole number from 1 to 9."},
      {"3.1.2.1 orientation", "#5703=10", "A whole number from 1 to 9."},
      {"3.1.2.1 orientation", "#5703=2.5", "A whole number from 1 to 9."},
  }));
  INFO(row.rule << ": " << row.setting);
  Bench bench;
  // M0 would pause in the middle of the line.
  const Outcome outcome = bench.run(std::string("G0 X1 M0 ") + row.setting + "\n");
  REQUIRE(outcome.failed);
  CHECK(outcome.diagnostic.code == ErrorCode::parameter_value_refused);
  CHECK(outcome.diagnostic.allowed == row.allowed);
  CHECK(outcome.lines.empty());
  CHECK(outcome.position == Position{});
  CHECK(bench.parameters.active_system() == 1);
  CHECK(bench.tools == config::ToolTable{});
}

TEST_CASE("A value that is too large in the unit of its own line is refused",
          "[conformance][LNG-1]") {
  // 500 is a length in mm; G20 on the line makes it 500 in = 12700 mm.
  Bench bench;
  CHECK_FALSE(bench.run("#5401=500\n").failed);
  const Outcome outcome = bench.run("G20 G0 X1 #5401=500\n");
  CHECK(outcome.diagnostic.code == ErrorCode::parameter_value_refused);
  CHECK(outcome.lines.empty());
  CHECK(outcome.modal.unit == LengthUnit::millimetre);
}

TEST_CASE("Whole parameters are the number that they mean", "[conformance][LNG-1]") {
  // Manual 3.2.2.1: within 0.0001 of a whole number.
  Bench bench;
  REQUIRE_FALSE(bench.run("#5220=1.99995 #5701=2.99995\n").failed);
  CHECK(bench.parameters.get(5220) == 2.0);
  CHECK(bench.tools.tool(1).orientation == 3);
}

TEST_CASE("Tool data are written to the tool table, in the program's unit",
          "[conformance][LNG-1]") {
  Bench bench;
  REQUIRE_FALSE(bench.run("#5403=12.5 #5503=6 #5603=-2 #5703=3\n").failed);
  CHECK(bench.tools.tool(3) ==
        config::Tool{
            .length = 12.5, .x_offset = -2, .diameter = 6, .orientation = 3, .description = {}});
  REQUIRE_FALSE(bench.run("G20\n#5403=1\n#1=#5403\n").failed);
  CHECK(bench.tools.tool(3).length == 25.4);
  CHECK(bench.parameters.get(1) == 1.0);
}

TEST_CASE("A written length counts at once when it is the one in force",
          "[conformance][LNG-1][CRD-2]") {
  CHECK(end_of("M6 T2\nG43\n#5402=10\nG0 Z0\n")[Axis::Z] == 10.0);
  CHECK(end_of("G43 H4\n#5404=10 #5604=2\nG0 X0 Z0\n")[Axis::X] == 2.0);
  CHECK(end_of("M6 T2\n#5402=10\nG0 Z0\n")[Axis::Z] == 0.0);       // G49
  CHECK(end_of("M6 T2\nG43\n#5403=10\nG0 Z0\n")[Axis::Z] == 0.0);  // another tool
  CHECK(end_of("M6 T2\nG43.1 K5\n#5402=10\nG0 Z0\n")[Axis::Z] == 5.0);
}

TEST_CASE("Tool data stay as they are while cutter compensation is on", "[conformance][LNG-1]") {
  Bench bench;
  REQUIRE(bench.tools.set(1, {.diameter = 2}));
  CHECK(bench.run("G41 D1\n#5501=4\n").diagnostic.code == ErrorCode::compensation_offset_change);
  CHECK(bench.tools.tool(1).diameter == 2.0);
  CHECK_FALSE(bench.run("G41 D1\nG40\n#5501=4\n").failed);
}

TEST_CASE("What the manual calls persistent is in the saved file", "[conformance][LNG-1]") {
  // 3.1.1: 4000-4999; and the offsets, which the store keeps with them.
  CHECK(config::ParameterStore::is_persistent(4000));
  CHECK(config::ParameterStore::is_persistent(4999));
  CHECK_FALSE(config::ParameterStore::is_persistent(3999));
  CHECK_FALSE(config::ParameterStore::is_persistent(5011));
  Bench bench;
  REQUIRE_FALSE(bench.run("#4000=1.5 #4999=-2 #3999=9\n").failed);
  const std::string text = bench.parameters.to_text();
  CHECK_THAT(text, Catch::Matchers::Contains("\n4000 1.5\n"));
  CHECK_THAT(text, Catch::Matchers::Contains("\n4999 -2\n"));
  CHECK_THAT(text, !Catch::Matchers::Contains("\n3999"));
}
