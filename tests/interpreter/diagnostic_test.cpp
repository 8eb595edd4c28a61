// How diagnostics read.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

TEST_CASE("A diagnostic shows place, line, wrong part and what is allowed", "[LNG-10]") {
  CHECK(run("G21\nG0 X1 T100\n").diagnostic.to_string() ==
        "test.ngc:2:7: error: T100 is not a tool. [E2308]\n"
        "  G0 X1 T100\n"
        "        ^~~~\n"
        "  allowed: T0 (no tool) to T99.\n");
}

TEST_CASE("The mark stands right behind tabs and characters of several bytes", "[LNG-10]") {
  CHECK(run("\tG0 (\xC3\xA4\xC3\xB6) T-1\n").diagnostic.to_string() ==
        "test.ngc:1:12: error: T-1 is not a tool. [E2308]\n"
        "  \tG0 (\xC3\xA4\xC3\xB6) T-1\n"
        "  \t        ^~~\n"
        "  allowed: T0 (no tool) to T99.\n");
}

TEST_CASE("A diagnostic becomes an error with file, line and column", "[LNG-10]") {
  const Error error = run("G0 X1 T100\n").diagnostic.to_error();
  CHECK(error.to_string() ==
        "test.ngc:1:7: T100 is not a tool. Allowed: T0 (no tool) to T99. [E2308]");
}

TEST_CASE("An arc with a radius too small is an error that names the word R", "[GCO-2][LNG-10]") {
  const Diagnostic diagnostic = run("F1\nG2 X10 R4\n").diagnostic;
  CHECK(diagnostic.sentence == "R is 4 mm; the end point is 10 mm away.");
  CHECK(diagnostic.allowed == "R of at least 5 mm.");
  CHECK(diagnostic.column == 8);
  CHECK(diagnostic.length == 2);
}

TEST_CASE("An unknown code is refused with the list of the known ones", "[LNG-10]") {
  const Diagnostic diagnostic = run("G77\n").diagnostic;
  CHECK(diagnostic.sentence == "G77 is not a code that this interpreter knows.");
  CHECK_THAT(diagnostic.allowed, Catch::Matchers::StartsWith("G0 G1 G2 G3 G4 G10 G17"));
}

TEST_CASE("After a failure the interpreter stays failed, or skips the line for a check",
          "[LNG-10]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  CHECK_FALSE(interpreter.skip_failed_line());
  interpreter.start(Program::from_text("G77\nG0 X1\n", "two").value(), {});
  CHECK(interpreter.next() == Progress::failed);
  CHECK(interpreter.next() == Progress::failed);
  CHECK(interpreter.skip_failed_line());
  CHECK(interpreter.next() == Progress::command);
  CHECK(interpreter.command().source.line == 2);
  CHECK(interpreter.next() == Progress::command);
  CHECK(interpreter.next() == Progress::ended);
  CHECK(interpreter.ran_off_end());
}
