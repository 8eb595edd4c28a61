#include "config/tool_table.h"

#include <catch2/catch.hpp>
#include <limits>

#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;
using Catch::Matchers::Contains;

namespace {

void check_refusal(std::string_view text, ErrorCode code, std::uint32_t line,
                   const std::string& part) {
  INFO(text);
  const auto refused = ToolTable::parse(text, "tools.txt");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == code);
  REQUIRE(refused.error().place);
  CHECK(refused.error().place->file == "tools.txt");
  CHECK(refused.error().place->line == line);
  CHECK_THAT(refused.error().message, Contains(part));
}

}  // namespace

TEST_CASE("Tool 0 is no tool: all zero, and it cannot be set", "[GCO-5]") {
  ToolTable table;
  CHECK(table.tool(0).length == 0.0);
  CHECK(table.tool(0).diameter == 0.0);
  const auto refused = table.set(0, {.length = 5.0});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::tool_bad_number);
  CHECK(table == ToolTable{});
}

TEST_CASE("Tools 1 to 99 can be set, no other", "[GCO-5]") {
  ToolTable table;
  REQUIRE(table.set(1, {.length = 1.0}));
  REQUIRE(table.set(99, {.length = 99.0}));
  CHECK_FALSE(table.set(100, {.length = 1.0}));
  CHECK_FALSE(table.set(-1, {.length = 1.0}));
  CHECK(table.tool(1).length == 1.0);
  CHECK(table.tool(99).length == 99.0);
  CHECK(table.tool(100) == table.tool(0));
  CHECK(table.tool(-1) == table.tool(0));
}

TEST_CASE("A tool that is not described is a milling tool of orientation 9", "[GCO-4]") {
  CHECK(ToolTable{}.tool(7).orientation == 9);  // manual 3.1.2.1: no offset compensation
}

TEST_CASE("A value out of range is refused and leaves the tool as it was", "[GCO-5]") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ToolTable table;
  const Tool good{12.5, -1.0, 6.0, 3, "good"};
  REQUIRE(table.set(5, good));
  const std::vector<std::pair<Tool, std::string>> bad{
      {{.length = 10'001}, "length"},
      {{.length = kNan}, "length"},
      {{.x_offset = -10'001}, "xOffset"},
      {{.diameter = -1001}, "diameter"},
      {{.diameter = 1001}, "diameter"},
      {{.orientation = 0}, "orientation"},
      {{.orientation = 10}, "orientation"},
      {{.description = "a\nb"}, "description"},
      {{.description = std::string(81, 'x')}, "description"}};
  for (const auto& [tool, word] : bad) {
    INFO(word);
    const auto refused = table.set(5, tool);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::tool_bad_value);
    CHECK_THAT(refused.error().message, Contains("Tool 5") && Contains(word));
    CHECK(table.tool(5) == good);
  }
}

TEST_CASE("A tool table comes back as it was saved", "[GCO-5][CFG-1]") {
  ToolTable written;
  REQUIRE(written.set(1, {0.0, 0.0, 3.175, 9, "Centre drill; the reference"}));
  REQUIRE(written.set(2, {2.623 * 25.4, 0.1, 6.35, 9, ""}));
  REQUIRE(written.set(42, {-1.0 / 3.0, -5.5, 0.4, 2, "  Wendeplatte 55°  "}));
  const test::TemporaryDirectory directory;
  REQUIRE(written.save(directory.file("tools")));
  const auto read = ToolTable::load(directory.file("tools"));
  REQUIRE(read);
  CHECK(*read == written);
  CHECK(read->tool(42).description == "Wendeplatte 55°");
}

TEST_CASE("A missing tool file is an empty table", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  CHECK(ToolTable::load(directory.file("none")).value() == ToolTable{});
}

TEST_CASE("A wrong line of the tool table is refused with its number", "[CFG-1]") {
  check_refusal("; head\n1 0 0 6\n", ErrorCode::tool_bad_line, 2, "\"1 0 0 6\"");
  check_refusal("1 0 0 six 9\n", ErrorCode::tool_bad_line, 1, "orientation");
  check_refusal("1 0 0 6 9.5\n", ErrorCode::tool_bad_line, 1, "\"1 0 0 6 9.5\"");
  check_refusal("0 0 0 6 9\n", ErrorCode::tool_bad_number, 1, "1 to 99");
  check_refusal("100 0 0 6 9\n", ErrorCode::tool_bad_number, 1, "Tool 100");
  check_refusal("1 0 0 6 9\n\n1 0 0 6 9\n", ErrorCode::tool_duplicate, 3, "Tool 1");
  check_refusal("1 0 0 -1006 9\n", ErrorCode::tool_bad_value, 1, "diameter is -1006");
}
