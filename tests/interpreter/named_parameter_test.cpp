// Named parameters, an extension: names and their scope as LinuxCNC documents them ("G-Code
// Overview", named parameters), but a value that nobody has set is an error instead of 0.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

/// The dwells of a program, in seconds, or its diagnostic.
std::string dwells_of(std::string_view text) { return moves_of(text); }

struct Row {
  const char* rule;
  const char* text;
  const char* expected;
};

}  // namespace

TEST_CASE("Named parameters stand wherever numbered ones do", "[LNG-1]") {
  const auto row = GENERATE(values<Row>({
      {"a word", "#<t> = 3\nG4 P#<t>", "dwell 3"},
      {"an expression", "#<t> = 3\nG4 P[#<t> * 2 + #<t>]", "dwell 9"},
      {"capitals and blanks mean nothing", "#<My Time> = 2\nG4 P#< mytime >", "dwell 2"},
      {"two names", "#<a>=1 #<b>=2\nG4 P[#<a> - #<b> + 5]", "dwell 4"},
      {"underscores, digits, hyphens", "#<a_1>=1\n#<a-1>=2\nG4 P#<a_1>\nG4 P#<a-1>",
       "dwell 1; dwell 2"},
      {"the number of a parameter", "#7=5\n#<n>=7\nG4 P##<n>\nG4 P#[#<n>]", "dwell 5; dwell 5"},
      {"a setting through it", "#<n>=7\n#[#<n>]=6\nG4 P#7", "dwell 6"},
      {"takes effect behind its line", "#<t>=1\n#<t>=2 G4 P#<t>\nG4 P#<t>", "dwell 1; dwell 2"},
      {"from itself", "#<t>=1\n#<t>=[#<t>+1]\nG4 P#<t>", "dwell 2"},
      {"a condition", "#<t>=0\nwhile [#<t> < 3]\n#<t>=[#<t>+1]\nendwhile\nG4 P#<t>", "dwell 3"},
      {"a text", "#<t>=2.5\n(x)\nG4 P#<t>\nmsg \"is \" #<t>", "dwell 2.5"},
      {"no comparison by its brackets: 1 or [2 * 0]", "#<a>=0\nG4 P[#<a> or 1 + 1]", "dwell 2"},
      {"EXISTS of a name without value", "G4 P[EXISTS[#<t>]]", "dwell 0"},
      {"EXISTS of a name with value", "#<t>=0\nG4 PEXISTS[#< T >]", "dwell 1"},
  }));
  INFO(row.rule);
  CHECK(dwells_of(row.text) == row.expected);
}

TEST_CASE("A name belongs to one call of a sub, one that begins with _ to all", "[LNG-1][LNG-6]") {
  const auto row = GENERATE(values<Row>({
      {"a sub has names of its own", "sub a\n#<t>=9\nG4 P#<t>\nendsub\n#<t>=1\ngosub a\nG4 P#<t>",
       "dwell 9; dwell 1"},
      {"they begin without value", "sub a\nG4 PEXISTS[#<t>]\n#<t>=1\nendsub\ngosub a\ngosub a",
       "dwell 0; dwell 0"},
      {"and end without", "sub a\n#<t>=1\nendsub\ngosub a\nG4 PEXISTS[#<t>]", "dwell 0"},
      {"global ones go in and out",
       "sub a\nG4 P#<_t>\n#<_t>=9\nendsub\n#<_t>=1\ngosub a\nG4 P#<_t>", "dwell 1; dwell 9"},
      {"each call of a recursion has its own",
       "sub a\n#<n>=#<_n>\n#<_n>=[#<_n>-1]\nif [#<_n> > 0]\ngosub a\nendif\nG4 P#<n>\nendsub\n"
       "#<_n>=3\ngosub a",
       "dwell 1; dwell 2; dwell 3"},
  }));
  INFO(row.rule);
  CHECK(dwells_of(row.text) == row.expected);
}

TEST_CASE("Names that are none, and names without value, are refused", "[LNG-1][LNG-10]") {
  const auto row = GENERATE(values<Row>({
      {"read before it is set", "G4 P#<t>", "parameter_unset@5"},
      {"a global one too", "G4 P[1 + #<_t>]", "parameter_unset@10"},
      {"set in the caller only", "#<t>=1\ngosub a\nsub a\nG4 P#<t>\nendsub", "parameter_unset@5"},
      {"no name", "#<> = 1", "name_expected@2"},
      {"blanks only", "#< > = 1", "name_expected@2"},
      {"a character that no name has", "#<a=b> = 1", "name_expected@2"},
      {"not closed", "#<a = 1", "named_parameter@2"},
      {"no number stands behind the names", "#10000 = 1", "parameter_number_invalid@2"},
      {"nor can one be computed", "#<t>=1\n#[10000] = 1", "parameter_number_invalid@2"},
      {"EXISTS of a number", "G4 P[EXISTS[#5]]", "name_expected@6"},
      {"EXISTS not closed", "G4 P[EXISTS[#<t>", "bracket_not_closed@6"},
  }));
  INFO(row.rule);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("The number of names is bounded", "[LNG-1][LNG-10]") {
  std::string text;
  for (int i = 1; i <= 10'000; ++i) text += "#<n" + std::to_string(i) + ">=1\n";
  CHECK(refusal_of(text).empty());
  CHECK(refusal_of(text + "#<one_more>=1\n") == "too_many_names@2");
}

TEST_CASE("A refused line sets no name", "[LNG-1][LNG-9]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  const auto run = [&](const std::string& text) {
    interpreter.start(Program::from_text(text, "job").value(), {});
    Progress progress = interpreter.next();
    while (progress == Progress::command) progress = interpreter.next();
    return progress;
  };
  REQUIRE(run("#<_t> = 5\n") == Progress::ended);
  REQUIRE(run("#<_t> = 7 G0 Q1\n") == Progress::failed);
  REQUIRE(run("if [#<_t> <> 5]\nG77\nendif\n") == Progress::ended);

  SECTION("global names stay from program to program, others do not") {
    REQUIRE(run("#<t> = 5\n") == Progress::ended);
    REQUIRE(run("if [EXISTS[#<t>] or EXISTS[#<_t>] == 0]\nG77\nendif\n") == Progress::ended);
  }
  SECTION("a program that fails within a sub leaves no names of it") {
    REQUIRE(run("gosub a\nsub a\n#<t> = 5\nG77\nendsub\n") == Progress::failed);
    REQUIRE(run("if [EXISTS[#<t>]]\nG77\nendif\n") == Progress::ended);
  }
}

TEST_CASE("A macro file can set global names when it is loaded", "[LNG-1][LNG-6]") {
  Bench bench;
  bench.add_macros("#<_height> = 4\n#<local> = 5\nsub a\nG4 P#<_height>\nendsub\n");
  CHECK(text_of(bench.run("gosub a")) == "DWELL(4.000000)");
  CHECK(refusal_of(bench.run("G4 P#<local>")) == "parameter_unset@5");
}

TEST_CASE("A search goes by the names and leaves them to the program", "[LNG-1][JOB-3]") {
  Bench bench;
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  const auto program = Program::from_text("#<x> = 4\nG0 X#<x>\n#<x> = 6\nG0 X#<x>\n", "job");
  interpreter.start(program.value(), {}, {.mode = RunMode::search, .search_line = 4});
  REQUIRE(interpreter.next() == Progress::found);
  CHECK(interpreter.position()[Axis::X] == 4.0);
  interpreter.leave_search(interpreter.position());
  REQUIRE(interpreter.next() == Progress::command);
  CHECK(interpreter.position()[Axis::X] == 6.0);
}

TEST_CASE("Where the manual is the rule there are no names", "[LNG-1][LNG-11]") {
  Bench strict;
  strict.settings.strict = true;
  CHECK(refusal_of(strict.run("#<depth> = 5\n")) == "named_parameter@2");
  CHECK(refusal_of(strict.run("G4 P[EXISTS[#<depth>]]\n")) == "named_parameter@14");
  Bench pscnc;
  pscnc.settings.dialect = DialectId::pscnc;
  CHECK(refusal_of(pscnc.run("#<depth> = 5\n")) == "named_parameter@2");
}
