// A refused line leaves no trace: state and commands are as if it had not been read, however far it
// had got.
#include <catch2/catch.hpp>
#include <string>

#include "interpreter/runner.h"

using namespace cnc;
using namespace cnc::interp;

namespace {

struct Trace {
  MachineState state;
  int commands = 0;
  std::uint32_t refused_line = 0;
};

/// Runs `text` until it fails.
Trace run_to_failure(const std::string& text) {
  config::ParameterStore parameters;
  config::ToolTable tools;
  const InterpreterSettings settings;
  Runner runner(settings, parameters, tools);
  runner.start(Program::from_text(text, "job").value(), {}, {});
  Trace trace;
  for (;;) {
    switch (runner.next()) {
      case Progress::command:
        ++trace.commands;
        break;
      case Progress::waiting:
        runner.answer(runner.expected_answer());
        break;
      case Progress::working:
      case Progress::found:
        break;
      case Progress::failed:
        trace.refused_line = runner.diagnostic().line;
        [[fallthrough]];
      case Progress::ended:
        trace.state = runner.state();
        return trace;
    }
  }
}

struct Row {
  std::string before;  ///< what runs well
  std::string wrong;
};

}  // namespace

TEST_CASE("A refused line leaves state and commands as they were", "[LNG-9]") {
  // Three things are noticed only when everything else of the line has been carried out: that A
  // turns against its brake (M26), that G20 makes a tool of 9000 too long (228.6 m), and that a
  // work offset changes under cutter compensation.
  const auto row = GENERATE(values<Row>({
      {"G0 X1 M26", "G0 X5 Y6 A7"},
      {"M26", "F100 G1 X5 A1"},
      {"F100 G1 X1 M26", "F77 X3 A5"},
      {"F100 G1 X1 M26", "(hello) F300 G0 Z3 C4 A5"},
      {"F100 G1 X1 M26", "F200 G3 X5 I2 A5"},
      {"G91 F100 G2 X1 R3 M26", "X1 R4 A1"},
      {"G20 F100 G1 X1 M26", "A5"},  // degrees instead of inches per minute
      {"F100 G1 X1", "F200 G2 X5 I77"},
      {"F100 G1 X1", "F200 G33 X5 K1"},
      {"G0 X1", "F0 G1 X5"},
      {"F100 G1 X1", "G93 F2 G20 X5 #5401=9000"},
      {"F100 G1 X1", "G20 G0 X5 M8 S100 T3 #5401=9000"},
      {"G0 X1", "G91 G20 G18 G90.1 G61.1 X3 #5401=9000"},
      {"G0 X1", "G20 G92 X7 #5401=9000"},
      {"G0 X1", "G20 G10 L2 P1 X7 #5401=9000"},
      {"G0 X1", "G20 G55 G43.1 K5 X3 #5401=9000"},
      {"G0 X1", "G20 G51 P2 I3 #5401=9000"},
      {"G0 X1", "G20 G68 R30 X1 Y2 #5401=9000"},
      {"F100 G0 X1", "G20 G81 X2 Z-5 R2 L3 #5401=9000"},
      {"F100 G0 X1", "G20 G41.1 D2 #5401=9000"},
      {"F100 G41.1 D2 G1 X10\nY10", "X0 F50 #5221=1"},  // an inside corner shortens the move
      {"F100 G42.1 D2 G1 X10\nY10", "X0 #5221=1"},      // around an outside corner
  }));
  CAPTURE(row.before, row.wrong);
  // A line that cannot even be read executes nothing.
  const Trace untouched = run_to_failure(row.before + "\n?\n");
  const Trace refused = run_to_failure(row.before + "\n" + row.wrong + "\n");
  REQUIRE(refused.refused_line != 0);
  REQUIRE(refused.refused_line == untouched.refused_line);
  CHECK(refused.commands == untouched.commands);
  CHECK(refused.state == untouched.state);
}
