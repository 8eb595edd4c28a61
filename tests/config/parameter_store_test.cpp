#include "config/parameter_store.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;
using Catch::Matchers::Contains;

namespace {

Error refusal(std::string_view text) {
  const auto result = ParameterStore::parse(text, "parameters.txt");
  REQUIRE_FALSE(result);
  return result.error();
}

void check_refusal(std::string_view text, ErrorCode code, std::uint32_t line,
                   const std::string& part) {
  INFO(text);
  const Error error = refusal(text);
  CHECK(error.code == code);
  REQUIRE(error.place);
  CHECK(error.place->file == "parameters.txt");
  CHECK(error.place->line == line);
  CHECK_THAT(error.message, Contains(part));
}

}  // namespace

TEST_CASE("A new store is all zero with G54 active", "[LNG-1][CRD-1]") {
  const ParameterStore store;
  for (std::int32_t number = 1; number <= 5799; ++number) {
    REQUIRE(store.get(number) == (number == 5220 ? 1.0 : 0.0));
  }
  CHECK(store.active_system() == 1);
}

TEST_CASE("Parameters are numbered from 1 to 5799", "[LNG-1]") {
  CHECK(ParameterStore::is_valid(1));
  CHECK(ParameterStore::is_valid(5799));
  for (const std::int32_t number : {0, -1, 5800, std::numeric_limits<std::int32_t>::min()}) {
    CHECK_FALSE(ParameterStore::is_valid(number));
  }
}

TEST_CASE("A number out of range touches no parameter", "[LNG-1]") {
  ParameterStore store;
  store.set(5800, 7.0);
  store.set(-1, 7.0);
  for (std::int32_t number = 1; number <= 5799; ++number) {
    REQUIRE(store.get(number) == (number == 5220 ? 1.0 : 0.0));
  }
}

TEST_CASE("Exactly the documented parameters survive power-off", "[LNG-1][CRD-1]") {
  // Manual 3.1.1: 4000-4999 (1000), G28 and G30 (2 x 6), G92 (6), 5220 (1), nine systems of six
  // offsets (54), eight reserved rotations: 1000 + 12 + 6 + 1 + 54 + 8.
  std::int32_t count = 0;
  for (std::int32_t n = -10; n < 6000; ++n) count += ParameterStore::is_persistent(n) ? 1 : 0;
  CHECK(count == 1081);
  for (const std::int32_t n : {4000, 4999, 5161, 5166, 5181, 5186, 5211, 5216, 5220, 5221, 5226,
                               5230, 5241, 5361, 5370, 5381, 5386}) {
    INFO(n);
    CHECK(ParameterStore::is_persistent(n));
  }
  for (const std::int32_t n : {1, 3999, 5000, 5160, 5167, 5180, 5187, 5210, 5217, 5219, 5227, 5229,
                               5231, 5240, 5387, 5390, 5399, 5401, 5421}) {
    INFO(n);
    CHECK_FALSE(ParameterStore::is_persistent(n));
  }
}

TEST_CASE("Work systems lie twenty parameters apart, their axes side by side", "[CRD-1]") {
  ParameterStore store;
  const Position offset{{1, 2, 3, 4, 5, 6}};
  store.set_work_offset(9, offset);
  CHECK(store.get(5381) == 1.0);  // manual: 5381-5386 Coord. System 9
  CHECK(store.get(5386) == 6.0);
  CHECK(store.work_offset(9) == offset);
  CHECK(store.work_offset(1) == Position{});
  store.set(5263, 7.5);  // manual: 5261-5266 Coord. System 3; Z is the third
  CHECK(store.work_offset(3)[Axis::Z] == 7.5);
}

TEST_CASE("G92, G28 and G30 have their places in the table", "[CRD-1][CRD-3]") {
  ParameterStore store;
  store.set(5211, 1.0);
  store.set(5162, 2.0);
  store.set(5186, 3.0);
  CHECK(store.g92_offset()[Axis::X] == 1.0);
  CHECK(store.g28_position()[Axis::Y] == 2.0);
  CHECK(store.g30_position()[Axis::C] == 3.0);
  store.set_g28_position({{9, 8, 7, 6, 5, 4}});
  CHECK(store.get(5161) == 9.0);
  CHECK(store.get(5166) == 4.0);
}

TEST_CASE("A program that spoils #5220 leaves G54 active", "[CRD-1]") {
  ParameterStore store;
  for (const double value : {0.0, 10.0, 1.5, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    store.set(5220, value);
    CHECK(store.active_system() == 1);
  }
  store.set_active_system(9);
  CHECK(store.active_system() == 9);
}

TEST_CASE("What persists comes back bit by bit, what does not persist does not", "[LNG-1]") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> value(-1e6, 1e6);
  ParameterStore written;
  for (std::int32_t n = 1; n <= 5799; ++n) written.set(n, value(random));
  written.set_active_system(4);

  const test::TemporaryDirectory directory;
  REQUIRE(written.save(directory.file("p")));
  const auto read = ParameterStore::load(directory.file("p"));
  REQUIRE(read);
  for (std::int32_t n = 1; n <= 5799; ++n) {
    REQUIRE(read->get(n) == (ParameterStore::is_persistent(n) ? written.get(n) : 0.0));
  }
}

TEST_CASE("An infinity that a program computed does not make the file unreadable", "[LNG-1]") {
  ParameterStore store;
  store.set(4000, std::numeric_limits<double>::infinity());
  store.set(4001, std::numeric_limits<double>::quiet_NaN());
  store.set(4002, 5.0);
  store.set(5220, 99.0);
  const auto read = ParameterStore::parse(store.to_text(), "p");
  REQUIRE(read);
  CHECK(read->get(4000) == 0.0);
  CHECK(read->get(4002) == 5.0);
  CHECK(read->active_system() == 1);
}

TEST_CASE("A missing file gives a new store; a directory is an error", "[LNG-1]") {
  const test::TemporaryDirectory directory;
  CHECK(ParameterStore::load(directory.file("none")).value() == ParameterStore{});
  CHECK(ParameterStore::load(directory.path()).error().code == ErrorCode::file_not_readable);
}

TEST_CASE("A wrong line is refused with its number, what was read and what is allowed", "[LNG-1]") {
  check_refusal("; head\n\n5221 1 2\n", ErrorCode::parameter_bad_line, 3, "\"5221 1 2\"");
  check_refusal("5221\n", ErrorCode::parameter_bad_line, 1, "number value");
  check_refusal("5221=3\n", ErrorCode::parameter_bad_line, 1, "\"5221=3\"");
  check_refusal("5221.0 3\n", ErrorCode::parameter_bad_line, 1, "\"5221.0 3\"");
  check_refusal("4000 1\n5221 1,5\n", ErrorCode::parameter_bad_value, 2, "\"1,5\"");
  check_refusal("5221 nan\n", ErrorCode::parameter_bad_value, 1, "finite");
  check_refusal("5220 0\n", ErrorCode::parameter_bad_value, 1, "1 (G54) to 9 (G59.3)");
  check_refusal("5220 1.5\n", ErrorCode::parameter_bad_value, 1, "whole number");
  check_refusal("5401 10\n", ErrorCode::parameter_not_persistent, 1, "#5401");
  check_refusal("-1 10\n", ErrorCode::parameter_not_persistent, 1, "4000-4999");
  check_refusal("4000 1\n4001 1\n4000 1\n", ErrorCode::parameter_duplicate, 3, "#4000");
}

TEST_CASE("A wrong parameter file on disk is refused with its path", "[LNG-1]") {
  const test::TemporaryDirectory directory;
  test::put(directory.file("p"), "4000 1\r\nrubbish\r\n");
  const auto refused = ParameterStore::load(directory.file("p"));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().place == TextPlace{directory.file("p").string(), 2, 1});
}
