// The numbers of canonical text are those of the fmt library, digit for digit.
#include "interpreter/decimal_text.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <random>
#include <string>
#include <vector>

using cnc::interp::append_six_decimals;

namespace {

std::string text_of(double value) {
  std::string text;
  append_six_decimals(text, {&value, 1});
  return text;
}

std::string library_text_of(double value) {
  const std::string text = fmt::format("{:.6f}", value);
  return text == "-0.000000" ? "0.000000" : text;
}

}  // namespace

TEST_CASE("Six decimals of canonical numbers are rounded and never a negative zero", "[GCO-1]") {
  struct Row {
    double value;
    std::string text;
  };
  const auto row = GENERATE(values<Row>({
      {0.0, "0.000000"},
      {-0.0, "0.000000"},
      {1.0, "1.000000"},
      {-25.4, "-25.400000"},
      {0.0000014, "0.000001"},
      {0.0000016, "0.000002"},
      {-0.0000004, "0.000000"},
      {-0.0000006, "-0.000001"},
      {0.9999996, "1.000000"},
      {999999.9999996, "1000000.000000"},
      {-123456.789, "-123456.789000"},
      {1e9, "1000000000.000000"},
  }));
  CHECK(text_of(row.value) == row.text);
}

TEST_CASE("Numbers are separated by commas and stand behind what the text holds already",
          "[GCO-1]") {
  std::string text = "(";
  append_six_decimals(text, std::array{-1e7, -1.5, 0.0, 12.25});  // the first one by the library
  CHECK(text == "(-10000000.000000, -1.500000, 0.000000, 12.250000");

  // More characters than are collected at once.
  std::string many;
  std::string expected;
  const std::vector<double> numbers(50, -987654.321);
  append_six_decimals(many, numbers);
  for (std::size_t i = 0; i < numbers.size(); ++i) expected += ", -987654.321000";
  CHECK(many == expected.substr(2));
}

TEST_CASE("Six decimals are the library's for a million numbers of every size", "[GCO-1]") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-9.0, 12.0);
  std::uniform_real_distribution<double> factor(-1.0, 1.0);
  int different = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double value = factor(random) * std::pow(10.0, exponent(random));
    if (text_of(value) != library_text_of(value)) ++different;
  }
  CHECK(different == 0);
}

// Halves of a millionth that a double holds exactly (k / 128 = 7812.5 k millionths), and their
// neighbours: the hardest to round.
TEST_CASE("Six decimals are the library's at and beside ties", "[GCO-1]") {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  int different = 0;
  for (int k = -200'001; k <= 200'001; k += 2) {
    const double tie = k / 128.0;
    for (const double value : {tie, std::nextafter(tie, kInfinity), std::nextafter(tie, 0.0)}) {
      if (text_of(value) != library_text_of(value)) ++different;
    }
    const double written = (k + 0.5) * 1e-6;  // near a tie, as far as a double can be
    if (text_of(written) != library_text_of(written)) ++different;
  }
  CHECK(different == 0);
}
