// if, while, sub, gosub and the text statements: manual 4.1 and 4.2.
#include <catch2/catch.hpp>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

/// The value that #1 has at the end of `text`.
double result_of(const std::string& text) { return end_of(text + "\nG0 X#1\n")[Axis::X]; }

}  // namespace

TEST_CASE("if takes one of its branches", "[LNG-3]") {
  CHECK(result_of("if [1]\n#1=1\nelse\n#1=2\nendif") == 1);
  CHECK(result_of("if [0]\n#1=1\nelse\n#1=2\nendif") == 2);
  CHECK(result_of("#1=5\nif [0]\n#1=1\nendif") == 5);
  CHECK(result_of("IF[1]then ; note\n#1=1\nElse : text\n#1=2\nEndIf") == 1);
  CHECK(result_of("if [#2 < 1]]\n#1=1\nend if (a bracket too many, as in existing macros)") == 1);
}

TEST_CASE("ifs stand within one another", "[LNG-3]") {
  const std::string text =
      "if [#2 == 1]\nif [#3 == 1]\n#1=11\nelse\n#1=10\nendif\nelse\nif [#3 == "
      "1]\n#1=1\nelse\n#1=99\n"
      "endif\nendif";
  CHECK(result_of("#2=1 #3=1\n" + text) == 11);
  CHECK(result_of("#2=1 #3=0\n" + text) == 10);
  CHECK(result_of("#2=0 #3=1\n" + text) == 1);
  CHECK(result_of("#2=0 #3=0\n" + text) == 99);
}

TEST_CASE("while repeats as long as its condition holds", "[LNG-3]") {
  CHECK(result_of("while [#1 < 10]\n#1=[#1+1]\nendwhile") == 10);
  CHECK(result_of("while [0]\n#1=5\nendwhile") == 0);
  // 3 rounds of 4
  CHECK(result_of("while [#2 < 3]\n#3=0\nwhile [#3 < 4]\n#1=[#1+1] #3=[#3+1]\nendwhile\n#2=[#2+1]\n"
                  "endwhile") == 12);
}

TEST_CASE("A repeated line uses the motion and the values of each round", "[LNG-3][GCO-1]") {
  // "X5" has no motion code of its own: first it is a G1, in the second round a G0.
  const Outcome outcome =
      run("F60\nG1 Y1\n#1=0\nwhile [#1 < 3]\nX#1\nG0 M9\n#1=[#1+1]\nendwhile\n");
  REQUIRE_FALSE(outcome.failed);
  std::vector<std::string> moves;
  for (const std::string& line : outcome.lines) {
    if (line.starts_with("STRAIGHT")) moves.push_back(line.substr(0, line.find(',')));
  }
  CHECK(moves == std::vector<std::string>{"STRAIGHT_FEED(0.000000", "STRAIGHT_FEED(0.000000",
                                          "STRAIGHT_TRAVERSE(1.000000",
                                          "STRAIGHT_TRAVERSE(2.000000"});
}

TEST_CASE("The example of section 4.2 drills twelve holes on a circle", "[LNG-3][LNG-4]") {
  const Outcome outcome = run(
      "sub do_circle_holes\n#1=0\nf100\ng0 z1 x0 y0\nwhile [#1 <> 360]\n   #2 = [10 * sin[#1]]\n"
      "   #3 = [10 * cos[#1]]\n   g0 x[#3] y[#2]\n   g1 z-1\n   g1 z1\n  #1 = [#1 + 30]\n"
      "  if [#1 == 360]\n     msg \"Done\"\n  else\n     msg \"processing at angle \"#1\n  endif\n"
      "endwhile\nendsub\ngosub do_circle_holes\nm30\n");
  REQUIRE_FALSE(outcome.failed);
  const auto count = [&](const std::string& part) {
    return std::count_if(outcome.lines.begin(), outcome.lines.end(), [&](const std::string& line) {
      return line.find(part) != std::string::npos;
    });
  };
  CHECK(count("STRAIGHT_FEED") == 24);
  CHECK(count("MESSAGE(\"processing at angle 30\")") == 1);
  CHECK(count("MESSAGE(\"processing at angle 330\")") == 1);
  CHECK(count("MESSAGE(\"Done\")") == 1);
  // The fourth hole stands at 90 degrees.
  CHECK(count("STRAIGHT_TRAVERSE(0.000000, 10.000000, 1.000000") == 1);
}

TEST_CASE("Subs are called before or behind their definition, in any case, and by themselves",
          "[LNG-3]") {
  CHECK(result_of("sub Add_1 ; note\n#1=[#1+1]\nendsub\nGOSUB add_1\ngosub ADD_1 (again)") == 2);
  CHECK(result_of("gosub later\nif [0]\nendif\nsub later\n#1=7\nendsub") == 7);
  CHECK(result_of("sub 3d\n#1=3\nendsub\ngosub 3d") == 3);
  CHECK(result_of("sub down\n#1=[#1+1]\nif [#1 < 5]\ngosub down\nendif\nendsub\ngosub down") == 5);
  CHECK(result_of(
            "sub outer\ngosub inner\n#1=[#1*10]\nendsub\nsub inner\n#1=4\nendsub\ngosub outer") ==
        40);
}

TEST_CASE("A sub that is called a thousand times is evaluated anew each time", "[LNG-3]") {
  // 0 + 1 + ... + 999
  CHECK(result_of("#2=0\nwhile [#2 < 1000]\ngosub add\n#2=[#2+1]\nendwhile\nif [0]\nsub add\n"
                  "#1=[#1+#2]\nendsub\nendif") == 499500);
}

TEST_CASE("A definition that is reached is not executed", "[LNG-3]") {
  CHECK(result_of("#1=1\nsub never\n#1=2\nend sub") == 1);
}

TEST_CASE("M30 within a sub ends the program", "[LNG-3][GCO-9]") {
  const Outcome outcome = run("sub finish\nM30\nendsub\ngosub finish\nG0 X5\n");
  REQUIRE_FALSE(outcome.failed);
  CHECK(outcome.lines.back() == "PROGRAM_END()");
  CHECK(outcome.position[Axis::X] == 0.0);
}

TEST_CASE("Flow that does not fit together is refused where it is met", "[LNG-3][LNG-10]") {
  struct Row {
    const char* text;
    const char* expected;
    std::uint32_t line;
  };
  const auto row = GENERATE(values<Row>({
      {"G0 X1\nif [1]\nG0 X2\n", "flow_unmatched@0", 2},
      {"G0 X1\nendif\n", "flow_unmatched@0", 2},
      {"else\n", "flow_unmatched@0", 1},
      {"if [0]\nelse\nelse\nendif\n", "flow_unmatched@0", 3},
      {"while [1]\n", "flow_unmatched@0", 1},
      {"endwhile\n", "flow_unmatched@0", 1},
      {"if [1]\nwhile [0]\nendif\nendwhile\n", "flow_unmatched@0", 1},
      {"sub a\nG0 X1\n", "flow_unmatched@0", 1},
      {"G0 X1\ngosub nowhere\n", "sub_unknown@7", 2},
      {"sub a\nendsub\nsub A\nendsub\ngosub a\n", "sub_duplicate@7", 5},
      {"sub a\ngosub a\nendsub\ngosub a\n", "calls_too_deep@7", 2},
      {"gosub\n", "name_expected@6", 1},
      {"if #1 > 2\nendif\n", "bracket_expected@4", 1},
      {"if [1] G0 X5\nendif\n", "unexpected_character@8", 1},
  }));
  INFO(row.text);
  CHECK(refusal_of(row.text) == row.expected);
  CHECK(run(row.text).diagnostic.line == row.line);
}

TEST_CASE("A diagnostic within subs names the calls that led there", "[LNG-10]") {
  const Outcome outcome = run("sub a\ngosub b\nendsub\nsub b\nG1 X1\nendsub\n\ngosub a\n");
  REQUIRE(outcome.failed);
  CHECK(outcome.diagnostic.line == 5);
  REQUIRE(outcome.diagnostic.call_stack.size() == 2);
  CHECK(outcome.diagnostic.call_stack[0].sub == "b");
  CHECK(outcome.diagnostic.call_stack[0].line == 2);
  CHECK(outcome.diagnostic.call_stack[1].sub == "a");
  CHECK(outcome.diagnostic.call_stack[1].line == 8);
}

TEST_CASE("Texts join quoted parts and values", "[LNG-4]") {
  struct Row {
    const char* text;
    const char* expected;
  };
  const auto row = GENERATE(values<Row>({
      {"msg \"value of #1 = \"#1\" and #2 = \"#2", "MESSAGE(\"value of #1 = 1.5 and #2 = -2\")"},
      {"MSG\"a\", \"b\" [#1*2] \"\"", "MESSAGE(\"ab3\")"},
      {"msg \"(a; b\" ; comment", "MESSAGE(\"(a; b\")"},
      {"logmsg \"n=\"[1/3]", "LOG(\"n=0.333333\")"},
      {"warnmsg \"check tool\"", "WARNING(\"check tool\"); PROGRAM_STOP()"},
  }));
  CHECK_THAT(commands_of(std::string("#1=1.5 #2=-2\n") + row.text),
             Catch::Matchers::Equals(row.expected));
}

TEST_CASE("errmsg shows its text and fails the program", "[LNG-4]") {
  const Outcome outcome = run("G0 X1\nerrmsg \"tool \"#5008\" is missing\"\nG0 X2\n");
  REQUIRE(outcome.failed);
  CHECK(outcome.lines.back() == "ERROR(\"tool 0 is missing\")");
  CHECK(outcome.diagnostic.code == ErrorCode::program_raised_error);
  CHECK(outcome.diagnostic.sentence == "tool 0 is missing");
  CHECK(outcome.diagnostic.line == 2);
  CHECK(outcome.position[Axis::X] == 1.0);
  CHECK(refusal_of("msg \"open") == "text_not_closed@5");
}

TEST_CASE("An endless loop gives the caller time again and again", "[LNG-3]") {
  Bench bench;
  bench.settings.lines_per_call = 100;
  const auto program = Program::from_text("while [1]\n#1=[#1+1]\nendwhile\n", "endless").value();
  Interpreter interpreter(bench.settings, bench.parameters, bench.tools);
  interpreter.start(program, {});
  for (int call = 0; call < 10; ++call) CHECK(interpreter.next() == Progress::working);
  interpreter.stop();
  CHECK(interpreter.next() == Progress::ended);
}
