// A plain motion line allocates nothing, and neither does a round of a loop.
#include <catch2/catch.hpp>

#include "tests/allocations.h"
#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;

namespace {

/// Allocations of all next() calls but those of the first `warm_up` commands.
std::size_t allocations_of(const std::string& text, int warm_up) {
  const auto program = Program::from_text(text, "plain").value();
  config::ParameterStore parameters;
  config::ToolTable tools;
  Interpreter interpreter({}, parameters, tools);
  interpreter.start(program, {});
  for (int i = 0; i < warm_up; ++i) REQUIRE(interpreter.next() == Progress::command);
  const std::size_t before = cnc::test::allocations();
  int commands = 0;
  while (interpreter.next() != Progress::ended) ++commands;
  const std::size_t after = cnc::test::allocations();
  REQUIRE(before > 0);  // the counter counts
  REQUIRE(commands > 1000);
  return after - before;
}

}  // namespace

TEST_CASE("Plain lines are interpreted without allocating", "[JOB-6]") {
  std::string text = "G21 G90\nF100\n";
  for (int i = 0; i < 2000; ++i) {
    text += "G1 X1.234 Y-2.5 Z" + std::to_string(i) + " F200\nX2\nG2 I1.5\nG0 Z5 M8 S100\n";
  }
  CHECK(allocations_of(text, 20) == 0);
}

TEST_CASE("Compensated lines are interpreted without allocating", "[JOB-6][GCO-4]") {
  std::string text = "F100\nG41.1 D2\nG1 X10\n";
  for (int i = 0; i < 1000; ++i) text += "Y10 M8\nX0\nY0\nX10\n";
  CHECK(allocations_of(text, 20) == 0);
}

TEST_CASE("Rounds of a loop are interpreted without allocating", "[JOB-6][LNG-3]") {
  const std::string text =
      "F100\nwhile [#1 < 2000]\n#2=[50*cos[#1]] #3=[sin[#1]*2]\nif [#1 > 5]\nG1 X#2 Y[#3+1]\nelse\n"
      "G1 X0\nendif\n#1=[#1+1]\nendwhile\n";
  CHECK(allocations_of(text, 20) == 0);
}
