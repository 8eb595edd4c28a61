// Conformance of the language around the codes: manual 3.2 (words, numbers, settings), table 3-3
// (which codes exclude each other) and table 3-7 (in which order a line is executed).
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <span>

#include "interpreter/code_table.h"
#include "tests/interpreter/conformance.h"
#include "tests/interpreter/support.h"

using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

/// Commands, or the refusal.
std::string result_of(const char* program) {
  const Outcome outcome = run(program);
  return outcome.failed ? refusal_of(outcome) : test::text_of(outcome);
}

/// A row of table 3-3: codes of which one may stand on a line, each with the words that it needs.
struct GroupRow {
  const char* name;
  std::vector<std::string> codes;
};

// The table's groups with the codes that it leaves out added where the text puts them; M64 M65 M66
// have no meaning anywhere (docs/canonical.md).
const std::vector<GroupRow>& groups() {
  static const std::vector<GroupRow> kGroups{
      {"0 non-modal",
       {"G4 P1", "G10 L2 P1", "G28", "G30", "G53", "G92", "G92.1", "G92.2", "G92.3"}},
      {"1 motion",
       {"G0", "G1", "G2", "G3", "G33", "G33.1", "G38.2", "G73", "G74", "G76", "G81", "G82", "G83",
        "G84", "G85", "G86", "G87", "G88", "G89"}},
      {"2 plane selection", {"G17", "G18", "G19"}},
      {"3 distance mode", {"G90", "G91"}},
      {"3 distance mode of arcs", {"G90.1", "G91.1"}},
      {"4 stopping", {"M0", "M1", "M2", "M30", "M60"}},
      {"5 feed rate mode", {"G93", "G94", "G95"}},
      {"5 inputs and outputs", {"M54 P1", "M55 P1", "M56 P1"}},
      {"6 units", {"G20", "G21", "G70", "G71"}},
      {"6 tool change", {"M6"}},
      {"7 cutter radius compensation", {"G40", "G41", "G42", "G41.1", "G42.1"}},
      {"7 spindle turning", {"M3", "M4", "M5"}},
      {"8 tool length offset", {"G43", "G43.1", "G49"}},
      {"8 coolant", {"M7", "M8", "M9"}},
      {"9 override switches", {"M48", "M49", "M50", "M51", "M52"}},
      {"10 return mode", {"G98", "G99"}},
      {"10 spindle", {"M90", "M91", "M92", "M93", "M95", "M97"}},
      {"12 coordinate system",
       {"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"}},
      {"13 path control", {"G61", "G61.1", "G64"}},
      {"14 rotation", {"G68", "G69"}},
      {"scaling", {"G50", "G51"}},
      {"spindle control", {"G96", "G97"}},
      {"THC", {"M20", "M21"}},
      {"clamp", {"M26", "M27"}},
  };
  return kGroups;
}

bool conflict(const std::string& first, const std::string& second) {
  return refusal_of(first + " " + second).starts_with("modal_group_conflict@");
}

}  // namespace

TEST_CASE("Every letter of table 3-2, in each of its meanings", "[conformance][GCO-1]") {
  const Row row = GENERATE(values<Row>({
      {"A B C, X Y Z: axes", "G0 X1 Y2 Z3 A4 B5 C6",
       "STRAIGHT_TRAVERSE(1.000000, 2.000000, 3.000000, 4.000000, 5.000000, 6.000000)"},
      {"D: tool radius compensation number", "#5501=6\nG41 D1\nG40", ""},
      {"F: feed rate", "F60", "SET_FEED_RATE(1.000000)"},
      {"G, P: dwell time with G4", "G4 P1", "DWELL(1.000000)"},
      {"H: tool length offset index", "#5401=7\nG43 H1",
       "USE_TOOL_LENGTH_OFFSET(7.000000, 0.000000)"},
      {"L, P: keys of G10", "G10 L2 P2 X1",
       "STORE_ORIGIN_OFFSETS(2, 1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
      {"M", "M8", "SET_COOLANT(MIST_OFF, FLOOD_ON)"},
      {"N: line number", "N99999 M8", "SET_COOLANT(MIST_OFF, FLOOD_ON)"},
      {"S: spindle speed", "S5", "SET_SPINDLE_SPEED(5.000000)"},
      {"T: tool selection", "T5", "SELECT_TOOL(5)"},
      {"I J: offsets of arcs", "F60 G2 X1 Y1 I1 J0",
       "SET_FEED_RATE(1.000000); ARC_FEED(1.000000, 1.000000, 1.000000, 0.000000, -1, 0.000000, "
       "0.000000, 0.000000, 0.000000)"},
      {"R: radius of arcs", "F60 G2 X1 Y1 R1",
       "SET_FEED_RATE(1.000000); ARC_FEED(1.000000, 1.000000, 1.000000, 0.000000, -1, 0.000000, "
       "0.000000, 0.000000, 0.000000)"},
      {"E belongs to M54 M56 and G76 only", "E1", "word_unused@1"},
      {"U V W are no words", "W1", "unexpected_character@1"},
  }));
  INFO(row.rule << ": " << row.program);
  CHECK(result_of(row.program) == row.expected);
}

TEST_CASE("What a number, a parameter and a setting may look like", "[conformance][LNG-1][LNG-2]") {
  // Each program leaves 2.5 in #1 if the rule holds.
  struct Form {
    const char* rule;
    const char* program;
  };
  const Form form = GENERATE(values<Form>({
      {"3.2.2.1 plus sign", "#1=+2.5"},
      {"3.2.2.1 zeros in front and behind", "#1=0002.50000"},
      {"3.2.2.1 no digit before the point", "#1=[2 + .5]"},
      {"3.2.2.1 no digit behind the point", "#1=[2. + 1/2]"},
      {"3.2.2.1 a negative number", "#1=[-2.5 * -1]"},
      {"3.2.2.1 more digits than are kept", "#1=2.49999999999999999999999999999"},
      {"3.2.2.1 an index within 0.0001 of an integer", "#7=2.5\n#1=#7.0001"},
      {"3.2.2.1 a G code times ten within 0.0001", "#1=2.5 G4.00001 P0"},
      {"3.2.2.1 an M code within 0.0001", "#1=2.5 M8.9999"},
      {"3.2.2.2 a parameter of a parameter", "#2=7 #7=2.5\n#1=##2"},
      {"3.2.2.2 # comes before +", "#2=1.5 #3=99\n#1=[#2+1]"},
      {"3.2.2.2 #[1+2] is parameter 3", "#3=2.5\n#1=#[1+2]"},
      {"3.2.2.3 # of an expression is set", "#[3-2]=2.5"},
      {"3.2.3 a setting takes effect behind its line", "#1=2.5\n#1=9 #2=#1\n#1=#2"},
      {"3.2.3 the last of two settings counts", "#1=9 #1=2.5"},
      {"3.2.3 settings in any order", "#2=2 #3=0.5\n#1=[#2+#3] #3=1 #2=1"},
      {"3.2.4 a comment between the items", "(one) #1=2.5 (two)"},
      {"3.2 blanks within a number", "# 1 = 2 . 5"},
      {"3.1.1 a word may be #1 …", "#2=2.5\nG0 X#2\n#1=#5001"},
  }));
  INFO(form.rule << ": " << form.program);
  Bench bench;
  REQUIRE(refusal_of(bench.run(form.program)).empty());
  CHECK(bench.parameters.get(1) == 2.5);
}

TEST_CASE("The manual's line of five items means the same in all 120 orders",
          "[conformance][GCO-1]") {
  // 3.2.6: "g40 g1 #3=15 (foo) #4=-7.0"
  std::array<std::string, 5> items{"g40", "g1", "#3=15", "(foo)", "#4=-7.0"};
  std::sort(items.begin(), items.end());
  int orders = 0;
  do {
    Bench bench;
    const Outcome outcome =
        bench.run(fmt::format("{} {} {} {} {}", items[0], items[1], items[2], items[3], items[4]));
    CHECK(test::text_of(outcome) == "COMMENT(\"foo\")");
    CHECK(outcome.modal.motion == 10);
    CHECK(bench.parameters.get(3) == 15.0);
    CHECK(bench.parameters.get(4) == -7.0);
    ++orders;
  } while (std::next_permutation(items.begin(), items.end()));
  CHECK(orders == 120);
}

TEST_CASE("Two codes of a group of table 3-3 exclude each other, in both orders",
          "[conformance][GCO-1]") {
  for (const GroupRow& group : groups()) {
    for (const std::string& first : group.codes) {
      for (const std::string& second : group.codes) {
        if (first == second) continue;
        INFO(group.name << ": " << first << " " << second);
        CHECK(conflict(first, second));
      }
      const std::string code = first.substr(0, first.find(' '));
      INFO(group.name << ": " << code << " " << code);
      CHECK(conflict(code, code));
    }
  }
}

TEST_CASE("Codes of different groups of table 3-3 do not exclude each other",
          "[conformance][GCO-1]") {
  for (const GroupRow& one : groups()) {
    for (const GroupRow& other : groups()) {
      if (&one == &other) continue;
      INFO(one.codes.front() << " " << other.codes.back());
      CHECK_FALSE(conflict(one.codes.front(), other.codes.back()));
    }
  }
}

TEST_CASE("Every code is in a group of table 3-3 or its documented additions",
          "[conformance][GCO-1]") {
  // docs/canonical.md: groups of their own, and G80, which counts beside another motion code.
  const std::string_view elsewhere =
      " G80 M22 M23 M53 M80 M81 M84 M85 M86 M87 M100 M104 M106 M107 M109 M140 M143 M190 ";
  const auto is_listed = [](std::string_view name) {
    for (const GroupRow& group : groups()) {
      for (const std::string& code : group.codes) {
        if (code.substr(0, code.find(' ')) == name) return true;
      }
    }
    return false;
  };
  for (const std::span<const Code> table : {g_codes(), m_codes()}) {
    for (const Code& code : table) {
      INFO(code.name);
      const bool is_addition = elsewhere.find(fmt::format(" {} ", code.name)) != elsewhere.npos;
      CHECK(is_listed(code.name) != is_addition);
    }
  }
}

TEST_CASE("Neighbours of table 3-7 are executed in its order, whatever the order of the line",
          "[conformance][GCO-1]") {
  // The later item stands first on each line. Items that give no command of their own are seen by
  // what they do to the other.
  const Row row = GENERATE(values<Row>({
      {"1 comment, 2 feed mode (seen by F)", "F6 G93 (note)",
       "COMMENT(\"note\"); SET_FEED_RATE(0.100000, INVERSE_TIME)"},
      {"2 feed mode, 3 F", "F2 G95", "SET_FEED_RATE(2.000000, PER_REVOLUTION)"},
      {"3 F, 4 S", "S5 F60", "SET_FEED_RATE(1.000000); SET_SPINDLE_SPEED(5.000000)"},
      {"4 S, 5 T", "T1 S5", "SET_SPINDLE_SPEED(5.000000); SELECT_TOOL(1)"},
      {"5 T, 6 tool change", "M6 T1", "SELECT_TOOL(1); CHANGE_TOOL(1)"},
      {"6 tool change, 7 spindle", "M3 M6", "CHANGE_TOOL(0); START_SPINDLE_CLOCKWISE()"},
      {"7 spindle, 8 coolant", "M8 M3",
       "START_SPINDLE_CLOCKWISE(); SET_COOLANT(MIST_OFF, FLOOD_ON)"},
      {"8 coolant, 9 overrides", "M49 M8",
       "SET_COOLANT(MIST_OFF, FLOOD_ON); ENABLE_OVERRIDES(FEED_OFF, SPEED_OFF)"},
      {"9 overrides, 10 dwell", "G4 P2 M49",
       "ENABLE_OVERRIDES(FEED_OFF, SPEED_OFF); DWELL(2.000000)"},
      {"10 dwell, 11 plane", "G18 G4 P2", "DWELL(2.000000); SELECT_PLANE(CANON_PLANE_XZ)"},
      {"11 plane, 12 units", "G20 G18",
       "SELECT_PLANE(CANON_PLANE_XZ); USE_LENGTH_UNITS(CANON_UNITS_INCHES)"},
      {"12 units, 13 compensation (under which units cannot change)", "G41 D0 G20",
       "USE_LENGTH_UNITS(CANON_UNITS_INCHES)"},
      {"13 compensation, 14 tool length (which cannot change under it in G18)",
       "G18\nG43.1 K5 G41 D0", "compensation_offset_change@1"},
      {"14 tool length, 15 coordinate system", "G55 G43.1 K5",
       "USE_TOOL_LENGTH_OFFSET(5.000000, 0.000000); "
       "SET_ORIGIN_OFFSETS(2, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
      {"15 coordinate system, 16 path control", "G64 G55",
       "SET_ORIGIN_OFFSETS(2, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS)"},
      {"17 distance mode, 19 home by way of X1 from X5", "G0 X5\nG28 X1 G91",
       "STRAIGHT_TRAVERSE(5.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "STRAIGHT_TRAVERSE(6.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "STRAIGHT_TRAVERSE(0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
      {"19 offsets, 20 motion", "G0 X5 G92.3\n#5211=3\nG0 X5 G92.3",
       "SET_G92_OFFSETS(0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "STRAIGHT_TRAVERSE(5.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "SET_G92_OFFSETS(3.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "STRAIGHT_TRAVERSE(8.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
      {"20 motion, 21 stop", "M0 G0 X1",
       "STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
       "PROGRAM_STOP()"},
  }));
  INFO(row.rule << ": " << row.program);
  CHECK(result_of(row.program) == row.expected);
}

TEST_CASE("18 retract mode comes before the cycle of its line", "[conformance][GCO-3]") {
  CHECK(moves_of("F60 G0 Z5\nG81 X1 Z-1 R2 G99") ==
        "rapid 0 0 5; rapid 1 0 5; rapid 1 0 2; feed 1 0 -1; rapid 1 0 2");
}

TEST_CASE("The code tables keep the order of table 3-7 from item to item", "[conformance][GCO-1]") {
  const auto step_of = [](std::string_view name) {
    if (name == "comment") return comment_item().step;
    if (name == "F") return feed_word().step;
    if (name == "S") return speed_word().step;
    if (name == "T") return tool_word().step;
    for (const std::span<const Code> table : {g_codes(), m_codes()}) {
      for (const Code& code : table) {
        if (code.name == name) return code.step;
      }
    }
    throw std::runtime_error(std::string(name));
  };
  const std::vector<std::vector<std::string_view>> items{
      {"comment"},
      {"G93", "G94", "G95"},
      {"F"},
      {"S"},
      {"T"},
      {"M6"},
      {"M3", "M4", "M5"},
      {"M7", "M8", "M9"},
      {"M48", "M49"},
      {"G4"},
      {"G17", "G18", "G19"},
      {"G20", "G21"},
      {"G40", "G41", "G42"},
      {"G43", "G49"},
      {"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"},
      {"G61", "G61.1", "G64"},
      {"G90", "G91"},
      {"G98", "G99"},
      {"G28", "G30", "G10", "G92", "G92.1", "G92.2", "G92.3"},
      {"G0", "G1", "G2", "G3", "G80", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88",
       "G89"},
      {"M0", "M1", "M2", "M30", "M60"},
  };
  REQUIRE(items.size() == 21);
  for (std::size_t i = 1; i < items.size(); ++i) {
    for (const std::string_view earlier : items[i - 1]) {
      for (const std::string_view later : items[i]) {
        INFO(earlier << " before " << later);
        CHECK(step_of(earlier) < step_of(later));
      }
    }
  }
}
