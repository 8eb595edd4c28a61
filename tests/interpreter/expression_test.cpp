// Expressions: manual 3.2.2 and 4.2, and NIST's own example program.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

struct Value {
  const char* expression;
  double expected;
};

double value_of(const std::string& expression) {
  return end_of("G0 X" + expression + "\n")[Axis::X];
}

}  // namespace

TEST_CASE("Operators and functions have the manual's values", "[LNG-2]") {
  const auto row = GENERATE(values<Value>({
      // The manual's example: [2.0 / 3 * 1.5 - 5.5 / 11.0] is 0.5.
      {"[2.0 / 3 * 1.5 - 5.5 / 11.0]", 0.5},
      {"[1 + acos[0] - [4 ** [4.0/2]]]", 1 + 90 - 16},
      {"[1 --3]", 4},
      {"[1/2+-0.5]", 0},
      {"[2 ** 3 ** 2]", 64},  // from left to right: (2 to the 3rd) squared
      {"[15 MOD 4.0]", 3},
      {"[-1 MOD 4]", 3},  // never negative
      {"[7 - 2 - 1]", 4},
      {"[0 OR 2]", 1},
      {"[2 AND 0]", 0},
      {"[2 XOR 3]", 0},
      {"[2 AND 1 + 3]", 4},  // third group from left to right: (2 AND 1) + 3
      {"[1 + 2 AND 3]", 1},
      {"FIX[2.8]", 2},
      {"FIX[-2.8]", -3},
      {"FUP[2.8]", 3},
      {"FUP[-2.8]", -2},
      {"INT[-2.8]", -2},
      {"ROUND[-0.5001]", -1},
      {"ROUND[2.444]", 2},
      {"ABS[-1.23]", 1.23},
      {"NOT[0]", 1},
      {"NOT[5]", 0},
      {"EXP[1]", 2.718281828459045},
      {"LN[10]", 2.302585092994046},
      {"SQRT[3**2 + 4**2]", 5},
      {"SIN[30]", 0.5},
      {"COS[60]", 0.5},
      {"TAN[45]", 1},
      {"ASIN[0.5]", 30},
      {"ATAN[1]/[-1]", 135},  // the quadrant counts
      {"ATAN[-1]/[-1]", -135},
      {"[6 BAND 3]", 2},
      {"[6 BOR 3]", 7},
      {"[6 BXOR 3]", 5},
      {"[1 << 4]", 16},
      {"[17 >> 2]", 4},
      {"-[2]", -2},
      {"-#1", 0},
      {"[-2 ** 2]", 4},  // the sign belongs to the number
      {"[- -3]", 3},
  }));
  INFO(row.expression);
  CHECK(value_of(row.expression) == Approx(row.expected).margin(1e-9));
}

TEST_CASE("Comparisons come after sums, and AND and OR after comparisons", "[LNG-2]") {
  const auto row = GENERATE(values<Value>({
      {"[30 + 30 == 60]", 1},
      {"[1 < 2]", 1},
      {"[2 < 1]", 0},
      {"[2 <= 2]", 1},
      {"[3 >= 4]", 0},
      {"[3 > 2]", 1},
      {"[1 <> 2]", 1},
      {"[1 <> 1]", 0},
      {"[7 > 5 AND 2 < 3]", 1},
      {"[7 > 5 AND 3 < 2]", 0},
      {"[7 < 5 OR 2 == 2]", 1},
      {"[[7 > 5] + [2 < 3]]", 2},
      {"[1 << 2 == 4]", 1},
      {"[0.1 + 0.2 == 0.3]", 1},  // rounding does not make a difference
      {"[0.1 + 0.2 > 0.3]", 0},
      {"[0.1 + 0.2 <= 0.3]", 1},
      {"[1 == 1.00001]", 0},
  }));
  INFO(row.expression);
  CHECK(value_of(row.expression) == row.expected);
}

TEST_CASE("Expressions that have no value are refused at the operation", "[LNG-2][LNG-10]") {
  struct Row {
    const char* text;
    const char* expected;
  };
  const auto row = GENERATE(values<Row>({
      {"G0 X[1/0]", "division_by_zero@7"},
      {"G0 X[1 MOD 0]", "division_by_zero@8"},
      {"G0 XSQRT[-1]", "argument_out_of_range@5"},
      {"G0 XLN[0]", "argument_out_of_range@5"},
      {"G0 XASIN[2]", "argument_out_of_range@5"},
      {"G0 XACOS[-2]", "argument_out_of_range@5"},
      {"G0 X[[-8] ** 0.5]", "argument_out_of_range@11"},
      {"G0 XEXP[1000]", "result_not_finite@5"},
      {"G0 X[10 ** 400]", "result_not_finite@9"},
      {"G0 X[1.5 BAND 1]", "whole_number_expected@10"},
      {"G0 X[1 << 99]", "argument_out_of_range@8"},
      {"G0 X[1 2 3 X4]", "operator_expected@12"},
      {"G0 X[1 + ]", "value_expected@10"},
      {"G0 X[1 + 2", "bracket_not_closed@5"},
      {"G0 XSIN30", "bracket_expected@8"},
      {"G0 XATAN[1]", "bracket_expected@5"},
      {"G0 XFOO[1]", "unknown_function@5"},
      {"G0 X#0", "parameter_number_invalid@6"},
      {"G0 X#5800", "parameter_number_invalid@6"},
      {"G0 X#1.5", "parameter_number_invalid@6"},
      {"G0 X#[-1]", "parameter_number_invalid@5"},
  }));
  INFO(row.text);
  CHECK(refusal_of(row.text) == row.expected);
}

TEST_CASE("Nesting is bounded, and the bound is far above what programs use", "[LNG-2][LNG-10]") {
  const auto nested = [](int depth) {
    return "G0 X" + std::string(static_cast<std::size_t>(depth), '[') + "1" +
           std::string(static_cast<std::size_t>(depth), ']') + "\n";
  };
  CHECK(end_of(nested(50))[Axis::X] == 1.0);
  CHECK_THAT(refusal_of(nested(1000)), Catch::Matchers::StartsWith("expression_too_deep@"));
}

TEST_CASE("An operand may wait at every precedence of every bracket", "[LNG-2]") {
  // 1 OR (2 < (3 + (4 * (5 ** ...)))) keeps four values waiting per level: the deepest allowed
  // nesting must not overflow the evaluator's stack.
  std::string text = "1";
  for (int level = 0; level < 40; ++level) text = "[0 OR 2 < 3 + 4 * 1 ** " + text + "]";
  CHECK(end_of("G0 X" + text + "\n")[Axis::X] == 1.0);
}

TEST_CASE("The # sign binds closest and can be repeated", "[LNG-1]") {
  CHECK(end_of("#1=2 #2=30 #3=99\nG0 X[#1+2]\n")[Axis::X] == 4.0);
  CHECK(end_of("#1=2 #2=30 #3=99\nG0 X#[1+2]\n")[Axis::X] == 99.0);
  CHECK(end_of("#1=2 #2=30\nG0 X##1\n")[Axis::X] == 30.0);
  CHECK(end_of("#1=2\n##1=0.375\nG0 X#2\n")[Axis::X] == 0.375);
}

TEST_CASE("A setting takes effect after the line; the last of two counts", "[LNG-1][GCO-1]") {
  CHECK(end_of("#3=15\n#3=6 G0 X#3\n")[Axis::X] == 15.0);
  CHECK(end_of("#3=15\n#3=6 G0 X#3\nX#3\n")[Axis::X] == 6.0);
  CHECK(end_of("#3=15 #3=6\nG0 X#3\n")[Axis::X] == 6.0);
}
