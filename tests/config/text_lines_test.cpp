#include "config/text_lines.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <sys/stat.h>

#include "config/nearest_name.h"
#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;

namespace {

std::vector<std::string> texts(std::string_view text) {
  std::vector<std::string> result;
  const auto lines = split_lines(text, "t").value();
  for (const TextLine& line : lines) result.emplace_back(line.text);
  return result;
}

}  // namespace

TEST_CASE("A byte order mark and Windows line ends are not part of any line", "[CFG-1]") {
  CHECK(texts("\xEF\xBB\xBF"
              "a\r\nb\nc") == std::vector<std::string>{"a", "b", "c"});
  CHECK(texts("") == std::vector<std::string>{});
  CHECK(texts("\n\n") == std::vector<std::string>{"", ""});
}

TEST_CASE("A line over the bound is refused with its number", "[CFG-1]") {
  const std::string longest(kMaxTextLineLength, 'x');
  CHECK(split_lines("a\n" + longest + "\r\n", "t").has_value());
  const auto refused = split_lines("a\n" + longest + "x\n", "t");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::text_line_too_long);
  CHECK(refused.error().place == TextPlace{"t", 2, 1});
}

TEST_CASE("A file over the bound, a missing file and a directory are refused", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  test::put(directory.file("full"), std::string(kMaxTextFileSize, '\n'));
  test::put(directory.file("over"), std::string(kMaxTextFileSize + 1, '\n'));
  CHECK(read_text_file(directory.file("full")).value().size() == kMaxTextFileSize);
  CHECK(read_text_file(directory.file("over")).error().code == ErrorCode::text_file_too_large);
  CHECK(read_text_file(directory.file("none")).error().code == ErrorCode::file_not_found);
  CHECK(read_text_file(directory.path()).error().code == ErrorCode::file_not_readable);
  CHECK(split_lines(std::string(kMaxTextFileSize + 1, '\n'), "t").error().code ==
        ErrorCode::text_file_too_large);
}

TEST_CASE("A pipe is refused at once instead of waited for", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  REQUIRE(::mkfifo(directory.file("pipe").c_str(), 0600) == 0);
  CHECK(read_text_file(directory.file("pipe")).error().code == ErrorCode::file_not_readable);
}

TEST_CASE("A number is the whole text or nothing") {
  CHECK(parse_number("1.5") == 1.5);
  CHECK(parse_number("+1.5") == 1.5);
  CHECK(parse_number("-.5") == -0.5);
  CHECK(parse_number("2e3") == 2000.0);
  for (const char* text : {"", " ", "1,5", "1.5 ", " 1.5", "1.5mm", "0x10", "+-1", "--1", "inf",
                           "nan", "1e999", "-1e999"}) {
    INFO(text);
    CHECK_FALSE(parse_number(text));
  }
  CHECK(parse_integer("+7") == 7);
  CHECK_FALSE(parse_integer("7.0"));
  CHECK_FALSE(parse_integer("99999999999"));
}

TEST_CASE("The text of a number reads back as the same double") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  std::uniform_int_distribution<int> exponent(-300, 300);
  for (int i = 0; i < 10'000; ++i) {
    const double value = std::ldexp(mantissa(random), exponent(random));
    REQUIRE(parse_number(number_text(value)) == value);
  }
  CHECK(number_text(24000.0) == "24000");
  CHECK(number_text(0.0025) == "0.0025");
}

TEST_CASE("Words are separated by any blanks") {
  CHECK(split_words(" a\t b  c ") == std::vector<std::string_view>{"a", "b", "c"});
  CHECK(split_words(" \t").empty());
}

TEST_CASE("Text in an error message is bounded and printable") {
  CHECK(in_quotes("a\tb\x01") == "\"a?b?\"");
  CHECK(in_quotes(std::string(500, 'x')).size() < 80);
}

TEST_CASE("The nearest name is the one with the fewest changes, capitals not counted") {
  const std::vector<std::string_view> names{"velocity", "homeVelocity", "acceleration"};
  CHECK(nearest_name("velocty", names) == "velocity");
  CHECK(nearest_name("HOMEVELOCITY", names) == "homeVelocity");
  CHECK(nearest_name("accelleration", names) == "acceleration");
  CHECK(nearest_name("", names) == "velocity");  // 8 insertions; the others need 12
  CHECK(nearest_name(std::string(900, 'z'), names) == "velocity");
}
