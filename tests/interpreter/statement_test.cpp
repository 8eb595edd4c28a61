// Statements of the language's own: manual 4.2.4, 2.2.5.5, 2.10.3, 2.1.9.
#include <array>
#include <catch2/catch.hpp>

#include "tests/interpreter/conformance.h"
#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

constexpr auto kRows = std::to_array<Row>(
    {{"4.2.4 msg", "#1 = 2\nmsg \"a=\"#1\" b=\"[#1 * 2]", "MESSAGE(\"a=2 b=4\")"},
     {"a printf directive behind the text is skipped", "msg \"done\" %d", "MESSAGE(\"done\")"},
     {"; and ( in quotes belong to the text", "msg \"a;b (c\"", "MESSAGE(\"a;b (c\")"},
     {"4.2.4 dlgmsg", "#100 = 5\ndlgmsg \"Give parameters\" par1 100 par2 101",
      "DIALOG(\"Give parameters\", \"par1\", #100=5.000000, \"par2\", #101=0.000000)"},
     {"quoted labels, numbers glued to them", "dlgmsg \"t\" \"A\" 1\"B\" 2",
      "DIALOG(\"t\", \"A\", #1=0.000000, \"B\", #2=0.000000)"},
     {"only a title: OK or Cancel", "DlgMsg \"Go on?\"", "DIALOG(\"Go on?\")"},
     {"fifteen fields (12 in the manual)",
      "dlgmsg \"t\" a 1 a 2 a 3 a 4 a 5 a 6 a 7 a 8 a 9 a 10 a 11 a 12 a 13 a 14 a 15",
      "DIALOG(\"t\", \"a\", #1=0.000000, \"a\", #2=0.000000, \"a\", #3=0.000000, \"a\", "
      "#4=0.000000, \"a\", #5=0.000000, \"a\", #6=0.000000, \"a\", #7=0.000000, \"a\", "
      "#8=0.000000, \"a\", #9=0.000000, \"a\", #10=0.000000, \"a\", #11=0.000000, \"a\", "
      "#12=0.000000, \"a\", #13=0.000000, \"a\", #14=0.000000, \"a\", #15=0.000000)"},
     {"4.2.4 logfile and logmsg", "LogFile \"text.txt\" 1\nLogMsg \"x=\"#5001",
      "LOG_OPEN(\"text.txt\", APPEND); LOG(\"x=0\")"},
     {"a new log", "logfile job.nc 0", "LOG_OPEN(\"job.nc\")"},
     {"4.2.4 sp", "SP points.txt 0", "STORE_POSITION(\"points.txt\")"},
     {"sp without a flag adds", "sp points.txt", "STORE_POSITION(\"points.txt\", APPEND)"},
     {"4.2.4 TCAGuard", "TCAGuard off\nTCAGuard on",
      "GUARD(TOOL_CHANGE_AREA, OFF); GUARD(TOOL_CHANGE_AREA, ON)"},
     {"4.2.4 MCAGuard", "MCAGuard off", "GUARD(MACHINE_AREA, OFF)"},
     {"4.2.4 HomeIsEstop", "HomeIsEstop on", "HOME_IS_ESTOP(ON)"},
     {"4.2.4 SetLafAngle", "SetLafAngle 5", "SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH, R5.000000)"},
     {"SetLafAngle takes an expression", "SetLafAngle atan[1]/[1]",
      "SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH, R45.000000)"},
     {"2.10 home", "home x", "HOME(X)"},
     {"2.10.3 tandem", "PrepareTandemHome X\nMoveSlaveToMaster A\nhomeTandem X",
      "PREPARE_TANDEM_HOME(X); MOVE_SLAVE_TO_MASTER(A); HOME_TANDEM(X)"},
     {"the manual's spelling in one place", "MoveStaveToMaster A", "MOVE_SLAVE_TO_MASTER(A)"},
     {"2.1.9 Tanknife",
      "Tanknife on\nTanknife on 90\nTanknife on -90\nTanknife b\nTanknife c\nTanknife lo\n"
      "Tanknife hi\nTanknife off",
      "TANGENTIAL_KNIFE(ON); TANGENTIAL_KNIFE(ON_90); TANGENTIAL_KNIFE(ON_-90); "
      "TANGENTIAL_KNIFE(B); TANGENTIAL_KNIFE(C); TANGENTIAL_KNIFE(LOW); "
      "TANGENTIAL_KNIFE(HIGH); TANGENTIAL_KNIFE(OFF)"},
     {"2.2.5.5 height map",
      "#4104 = 2\nZHCINIT [#4104] [3] [4]\nZHCADDPOINT\nZHCS zHeightCompTable.txt\nZHC on\nZHC "
      "off",
      "HEIGHT_MAP(INIT, 2.000000, 3, 4); HEIGHT_MAP(ADD_POINT); "
      "HEIGHT_MAP(STORE, \"zHeightCompTable.txt\"); HEIGHT_MAP(ON); HEIGHT_MAP(OFF)"},
     {"the grid is in the unit of the program", "G20\nZHCINIT 1 2 2",
      "USE_LENGTH_UNITS(CANON_UNITS_INCHES); HEIGHT_MAP(INIT, 25.400000, 2, 2)"}});

}  // namespace

std::span<const Row> cnc::interp::test::statement_rows() { return kRows; }

TEST_CASE("Each statement gives its command", "[LNG-4][LNG-5]") {
  const Row row = GENERATE(from_range(kRows));
  CAPTURE(row.rule, row.program);
  CHECK(commands_of(row.program) == row.expected);
}

TEST_CASE("A statement with the wrong things behind it names what is right", "[LNG-5][LNG-10]") {
  const auto row = GENERATE(
      Row{"no argument", "TCAGuard", "statement_argument@1"},
      Row{"neither on nor off", "TCAGuard maybe", "statement_argument@10"},
      Row{"a number instead of a word", "MCAGuard 1", "statement_argument@1"},
      Row{"no axis", "home w", "statement_argument@6"},
      Row{"a bent knife", "tanknife on 45", "statement_argument@13"},
      Row{"a label without a number", "dlgmsg \"t\" \"A\"", "statement_argument@1"},
      Row{"a field for no parameter", "dlgmsg \"t\" \"A\" 6000", "parameter_number_invalid@16"},
      Row{"a flag that is not 0 or 1", "logfile \"a\" 2", "statement_argument@13"},
      Row{"an angle that is none", "setlafangle 181", "word_out_of_range@13"},
      Row{"a grid without size", "zhcinit 0 2 2", "statement_argument@9"},
      Row{"too many points", "zhcinit 1 2000 2", "statement_argument@9"},
      Row{"an open text", "logfile \"a", "text_not_closed@9"},
      Row{"no such statement", "getjobdistance", "unknown_statement@1"});
  CAPTURE(row.rule, row.program);
  CHECK(refusal_of(row.program) == row.expected);
}

TEST_CASE("SP stores the work position of its place in the program", "[LNG-4]") {
  Bench bench;
  Position seen;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  interpreter.start(Program::from_text("G92 X5\nG0 X7 Y2\nsp a.txt", "p").value(), {});
  while (interpreter.next() == Progress::command) {
    if (const auto* store = std::get_if<StorePosition>(&interpreter.command().body)) {
      seen = store->work_position;
    }
  }
  CHECK(seen[Axis::X] == 7.0);
  CHECK(seen[Axis::Y] == 2.0);
}
