#include "config/error.h"

#include <catch2/catch.hpp>
#include <functional>
#include <set>

#include "tests/config/temporary_directory.h"

using namespace cnc;

TEST_CASE("The error table is ascending, and every row says something") {
  std::set<std::string_view> names;
  auto last = ErrorCode{};
  for (const ErrorInfo& row : error_table()) {
    INFO(row.name);
    CHECK(row.code > last);
    CHECK(names.insert(row.name).second);
    CHECK(row.sentence.ends_with('.'));
    CHECK_FALSE(row.check.empty());
    last = row.code;
  }
}

TEST_CASE("Every code finds its own row, and an unknown one finds internal_error") {
  for (const ErrorInfo& row : error_table()) CHECK(error_info(row.code).name == row.name);
  CHECK(error_info(ErrorCode{65000}).name == "internal_error");
}

TEST_CASE("An error's text leads with its place and ends with its number") {
  const Error error{ErrorCode::file_not_found, "No such file.", TextPlace{"cnc.ini", 12, 3}};
  CHECK(error.to_string() == "cnc.ini:12:3: No such file. [E1001]");
  CHECK(
      Error{ErrorCode::file_not_found, "No such file.", TextPlace{"cnc.ini", 12, 0}}.to_string() ==
      "cnc.ini:12: No such file. [E1001]");
  CHECK(Error{ErrorCode::file_not_found, "No such file.", TextPlace{"cnc.ini"}}.to_string() ==
        "cnc.ini: No such file. [E1001]");
  CHECK(Error{ErrorCode::file_not_found, "No such file.", std::nullopt}.to_string() ==
        "No such file. [E1001]");
}

TEST_CASE("The page of the errors is the one that the table writes", "[LNG-10]") {
  INFO("reference_pages errors > docs/errors.md brings the page up to date");
  CHECK(config::test::content_of(CNC_SOURCE_DIR "/docs/errors.md") == errors_as_markdown());
}
