// What real users' macro files contain: one row per construct of the survey of such files, as the
// body of a sub of macro.cnc. Versions after 4.01 of the original added some of them.
#include <array>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

struct Row {
  const char* construct;
  const char* body;  ///< of the sub t
  const char* expected;
};

std::string result_of(Bench& bench, const std::string& job) {
  const Outcome outcome = bench.run(job);
  return outcome.failed ? refusal_of(outcome) : test::text_of(outcome);
}

// "ok" is said by what was understood.
constexpr auto kStructure = std::to_array<Row>({
    {"words in any case", "IF [1]\nMSG \"ok\"\nendIf", "MESSAGE(\"ok\")"},
    {"if with then", "if [1] then\nmsg \"ok\"\nendif", "MESSAGE(\"ok\")"},
    {"then glued to the bracket", "If [1]then\nmsg \"ok\"\nendif", "MESSAGE(\"ok\")"},
    {"no blank before the bracket", "if[1]\nwhile[#1 < 1]\n#1=1\nmsg \"ok\"\nendwhile\nendif",
     "MESSAGE(\"ok\")"},
    {"ten ifs within one another",
     "if [1]\nif [1]\nif [1]\nif [1]\nif [1]\nif [1]\nif [1]\nif [1]\nif [1]\nif [1]\nmsg \"ok\"\n"
     "endif\nendif\nendif\nendif\nendif\nendif\nendif\nendif\nendif\nendif",
     "MESSAGE(\"ok\")"},
    {"text behind else", "if [0]\nElse : the other one\nmsg \"ok\"\nendif", "MESSAGE(\"ok\")"},
    {"a bracket too many", "if [#5003 < 5]]\nmsg \"ok\"\nendif", "MESSAGE(\"ok\")"},
    {"end sub in two words, subs further down", "gosub u\nend sub\nsub u\nmsg \"ok\"",
     "MESSAGE(\"ok\")"},
    {"a sub name with a digit in front", "gosub 3dprobe\nendsub\nSub 3dProbe\nmsg \"ok\"",
     "MESSAGE(\"ok\")"},
    {"a sub that calls itself", "#1=[#1+1]\nif [#1 < 5]\ngosub t\nelse\nmsg #1\nendif",
     "MESSAGE(\"5\")"},
    {"M30 in a sub ends everything", "M30\nendsub\nsub u\nmsg \"not\"", ""},
    {"an own M code with letters", "M99 X2 Y-1\nendsub\nsub M99\nmsg #24\" \"#25\" \"#26",
     "MESSAGE(\"2 -1 -10000000000\")"},
    {"a letter that was not given is below -1e9",
     "M99 X2\nendsub\nsub m99\nif [#25 < -1000]\nmsg \"ok\"\nendif", "MESSAGE(\"ok\")"},
    {"M5 replaced, the inner one is real", "m5\nendsub\nsub m5\nmsg \"ok\"\nm5",
     "MESSAGE(\"ok\"); STOP_SPINDLE_TURNING()"},
    {"M6T[#…] within a sub", "#5=3\nm6t[#5]", "SELECT_TOOL(3); CHANGE_TOOL(3)"},
});

constexpr auto kLines = std::to_array<Row>({
    {"no blanks", "G4P0.5M8", "SET_COOLANT(MIST_OFF, FLOOD_ON); DWELL(0.500000)"},
    {"blanks between letter and value", "G4 P [#1+1]", "DWELL(1.000000)"},
    {"signs before values, parameters and brackets",
     "#1=3 #2=-[4]\n#3=-#1\nG4P+1\nG4P-#3\nG4P-[#2]\nG4P[-1*#3]",
     "DWELL(1.000000); DWELL(3.000000); DWELL(4.000000); DWELL(3.000000)"},
    {"P#5220 and P[#5220]", "G10L20P#5220X0\nG10 L20 P[#5220] X0",
     "SET_ORIGIN_OFFSETS(1, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
     "SET_ORIGIN_OFFSETS(1, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000)"},
    {"indirect parameters", "#1=7 #7=2\nG4 P#[#1]\n#[#1+1]=5\nG4 P#8",
     "DWELL(2.000000); DWELL(5.000000)"},
    {"several M codes", "M5 M9 M27 M90",
     "SELECT_HEAD(SPINDLE_0, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000, 0.000000); "
     "STOP_SPINDLE_TURNING(); SET_COOLANT(MIST_OFF, FLOOD_OFF); UNCLAMP_AXIS(A)"},
    {"only F, only S, S0", "F600\nS100\nS0",
     "SET_FEED_RATE(10.000000); SET_SPINDLE_SPEED(100.000000); SET_SPINDLE_SPEED(0.000000)"},
    {"G97 S M4 on a line", "G97 S500 M4",
     "SET_SPINDLE_SPEED(500.000000); START_SPINDLE_COUNTERCLOCKWISE()"},
    {"G4 P0", "G4 P0", "DWELL(0.000000)"},
    {"M0 to let the operator jog", "M0", "PROGRAM_STOP()"},
    {"warnmsg stops too", "warnmsg \"ok\"", "WARNING(\"ok\"); PROGRAM_STOP()"},
    {"outputs, inputs, an extension card", "M54 P1\nM55 P101\nM56 P2 L1 Q5\nM80\nM48",
     "SET_OUTPUT(1, ON); SET_OUTPUT(101, OFF); READ_INPUT(2, HIGH, 5.000000); ENABLE_DRIVES(ON); "
     "ENABLE_OVERRIDES(FEED_ON, SPEED_ON)"},
    {"M50 P0", "M50 P0", "SET_OVERRIDE(FEED, 0.000000)"},
    {"M20 M21", "M20\nM21", "TORCH_HEIGHT_CONTROL(ON); TORCH_HEIGHT_CONTROL(OFF)"},
});

constexpr auto kTexts = std::to_array<Row>({
    {"comments behind code and alone", "G4 P1 ;; wait\n;;\n(alone)",
     "COMMENT(\"; wait\"); DWELL(1.000000); COMMENT(\";\"); COMMENT(\"alone\")"},
    {"; ( and a tab in quotes are text", "msg \"a;b (c\td\"", "MESSAGE(\"a;b (c\td\")"},
    {"UTF-8", "msg \"Fr\xC3\xA4ser\"", "MESSAGE(\"Fr\xC3\xA4ser\")"},
    {"Latin-1", "msg \"Fr\xE4ser\"", "MESSAGE(\"Fr\xE4ser\")"},
    {"five joined parts", "#1=1\nmsg \"a\"#1\"b\"[#1+1]\"c\"", "MESSAGE(\"a1b2c\")"},
    {"with commas, blanks and an empty text", "#1=1\nmsg \"a=\" , #1 \"\"", "MESSAGE(\"a=1\")"},
    {"%d behind the text", "msg \"ok\" %d", "MESSAGE(\"ok\")"},
    {"a long text", "msg \"12345678901234567890123456789012345678901234567890123456789012345\"",
     "MESSAGE(\"12345678901234567890123456789012345678901234567890123456789012345\")"},
    {"errmsg ends the program", "errmsg \"no tool\"", "program_raised_error@0"},
    {"logfile without quotes, begun and gone on with", "logfile part.nc 0\nlogfile part.nc 1",
     "LOG_OPEN(\"part.nc\"); LOG_OPEN(\"part.nc\", APPEND)"},
    {"logmsg writes program lines", "#1=0.1 #2=[1/3]\nlogmsg \"G1X\"#1\"Y\"[-2]\"Z\"#2",
     "LOG(\"G1X0.1Y-2Z0.333333\")"},
    {"a number that touches the closing quote", "dlgmsg \"t\" \"A\"100",
     "DIALOG(\"t\", \"A\", #100=0.000000)"},
    {"a question with a title only", "dlgmsg \"Go on?\"\nif [#5398 == 1]\nmsg \"ok\"\nendif",
     "DIALOG(\"Go on?\"); MESSAGE(\"ok\")"},
});

constexpr auto kExpressions = std::to_array<Row>({
    {"all operators of section 3.5",
     "#1=[[7 mod 4] * 2 - 8/4 + 2**3]\nif [#1 == 12 and #1 <> 11 and [#1 > 11 or #1 < 0]]\nmsg #1\n"
     "endif",
     "MESSAGE(\"12\")"},
    {"functions", "msg [abs[-1] + sqrt[4] + sin[30] + cos[60] + tan[45] + atan[1]/[1]]",
     "MESSAGE(\"50\")"},
    {"a comparison is 0 or 1", "#1=[2 > 1]\nmsg #1", "MESSAGE(\"1\")"},
    {"a tolerance: 0.1 ten times is 1",
     "while [#2 < 10]\n#1=[#1+0.1] #2=[#2+1]\nendwhile\nif [#1 == 1]\nmsg \"ok\"\nendif",
     "MESSAGE(\"ok\")"},
    {"nested brackets", "msg [[1 + [2 * [3 - 1]]] * 2]", "MESSAGE(\"10\")"},
});

constexpr auto kCommands = std::to_array<Row>({
    {"homing", "home x\nhomeTandem y\nhomeIsEstop on",
     "HOME(X); HOME_TANDEM(Y); HOME_IS_ESTOP(ON)"},
    {"TCAGuard", "TCAGuard off", "GUARD(TOOL_CHANGE_AREA, OFF)"},
    {"height map", "ZHCINIT 10 3 3\nZHCADDPOINT\nZHCS map.txt\nZHC on",
     "HEIGHT_MAP(INIT, 10.000000, 3, 3); HEIGHT_MAP(ADD_POINT); HEIGHT_MAP(STORE, \"map.txt\"); "
     "HEIGHT_MAP(ON)"},
    // Statements of later versions are refused by name, where they stand.
    {"GetToolInfo (4.03)", "GetToolInfo num 5025", "unknown_statement@1"},
    {"modbus (4.03)", "modbus s1 f5 a22 v1", "unknown_statement@1"},
    {"exec (4.02)", "exec \"a\"", "unknown_statement@1"},
    {"ZHCINITEX (4.03)", "zhcinitex 1 2 2", "unknown_statement@1"},
    {"and harm nobody in a branch that is not taken", "if [0]\nmodbus s1\nendif\nmsg \"ok\"",
     "MESSAGE(\"ok\")"},
});

constexpr auto kVariables = std::to_array<Row>({
    {"writing #5398, #5011, #5015", "#5398=-1\n#5011=4\n#5015=1\nmsg #5398\" \"#5011\" \"#5015",
     "MESSAGE(\"-1 4 1\")"},
    {"scratch up to #4999 and kept from #4000", "#3500=1 #4999=2\nmsg #3500\" \"#4999",
     "MESSAGE(\"1 2\")"},
    {"tool data", "#5401=7 #[5500+1]=6 #5601=1\nmsg #5401\" \"#5501\" \"#5601",
     "MESSAGE(\"7 6 1\")"},
    {"limits, map, head, simulation and rendering of a machine that has none",
     "msg #5101 #5113 #5151 #5380 #5394 #5397", "SYNCHRONISE(); MESSAGE(\"000000\")"},
    {"the probe input and the spindle's speed", "msg #5068 [#5070*60]",
     "SYNCHRONISE(); MESSAGE(\"00\")"},
});

void check_in_sub(const Row& row) {
  INFO(row.construct << ":\n" << row.body);
  Bench bench;
  bench.add_macros(fmt::format("sub t\n{}\nendsub\n", row.body));
  CHECK(result_of(bench, "gosub t") == row.expected);
  // The same with the line ends and the mark that editors under Windows leave.
  std::string windows = fmt::format("\xEF\xBB\xBFsub t\n{}\nendsub\n", row.body);
  for (std::size_t at = windows.find('\n'); at != windows.npos; at = windows.find('\n', at + 2)) {
    windows.insert(at, 1, '\r');
  }
  Bench edited;
  edited.add_macros(windows);
  CHECK(result_of(edited, "gosub t") == row.expected);
}

}  // namespace

TEST_CASE("Structure of users' macro files", "[LNG-3][LNG-6]") {
  check_in_sub(GENERATE(from_range(kStructure)));
}
TEST_CASE("Lines and words of users' macro files", "[LNG-6][GCO-1]") {
  check_in_sub(GENERATE(from_range(kLines)));
}
TEST_CASE("Texts of users' macro files", "[LNG-4][LNG-6]") {
  check_in_sub(GENERATE(from_range(kTexts)));
}
TEST_CASE("Expressions of users' macro files", "[LNG-2][LNG-6]") {
  check_in_sub(GENERATE(from_range(kExpressions)));
}
TEST_CASE("Special commands of users' macro files", "[LNG-5][LNG-6]") {
  check_in_sub(GENERATE(from_range(kCommands)));
}
TEST_CASE("Variables that users' macro files rely on", "[LNG-1][LNG-6]") {
  check_in_sub(GENERATE(from_range(kVariables)));
}

TEST_CASE("G53 stands before or behind the motion and with G38.2, as users write it", "[LNG-6]") {
  const auto [text, expected] = GENERATE(table<const char*, const char*>({
      {"G92 Z5\nG0 G53 Z1", "rapid 0 0 1"},
      {"G92 Z5\nG53 G0 Z1", "rapid 0 0 1"},
      {"G92 Z5 F60\nG53 G38.2 Z-9", "probe 0 0 -9"},
      {"G92 Z5 F60\nG38.2 G53 Z-9", "probe 0 0 -9"},
      {"G38.2 G91 Z-20 F30", "probe 0 0 -20"},
      {"G90 G38.2 Z-20 F30", "probe 0 0 -20"},
      {"M5 M9 G28", "spindle off; rapid 0 0 0"},
      {"M3 G96 S60 D2000", "spindle cw"},
  }));
  INFO(text);
  CHECK(moves_of(text) == expected);
}

TEST_CASE("200 lines of logmsg go into one log", "[LNG-4]") {
  Bench bench;
  bench.add_macros(
      "sub t\nlogfile a.nc 0\nwhile [#1 < 200]\n#1=[#1+1]\nlogmsg \"N\"#1\nendwhile\n"
      "endsub\n");
  const Outcome outcome = bench.run("gosub t");
  REQUIRE(outcome.lines.size() == 202);
  CHECK(outcome.lines[200] == "LOG(\"N200\")");
}

TEST_CASE("Macros see that they are only rendered", "[LNG-8]") {
  Bench bench;
  bench.mode = RunMode::render;
  bench.add_macros(
      "sub t\nif [#5397 == 0]\nF60 G38.2 Z-50\nelse\nmsg \"preview\"\nendif\nendsub\n");
  CHECK(result_of(bench, "gosub t") == "MESSAGE(\"preview\")");
}

TEST_CASE("Free text outside of subs, of any kind, is a warning", "[LNG-6]") {
  Bench bench;
  bench.add_macros(
      "@unit mm\n4700 | diameter ] of the \"tool\n<<< >>>\n#1\nsub t\nmsg \"ok\"\nendsub");
  const Outcome outcome = bench.run("gosub t");
  CHECK(test::text_of(outcome) == "MESSAGE(\"ok\")");
  CHECK(outcome.library_warnings.size() == 4);
}
