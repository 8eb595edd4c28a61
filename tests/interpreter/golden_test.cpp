// Programs with the commands that they must give: one folder of golden/ per case. program.ngc is
// run; expected.txt holds the commands, and after them the diagnostic if the program is to be
// refused. expected.txt is written by hand or checked by hand against the manual, never just copied
// from a run.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

TEST_CASE("Golden programs give exactly the expected commands", "[GCO-1][GCO-2]") {
  const std::filesystem::path folder = std::string(CNC_SOURCE_DIR) + "/tests/interpreter/golden";
  std::vector<std::filesystem::path> cases;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    cases.push_back(entry.path());
  std::sort(cases.begin(), cases.end());
  REQUIRE(cases.size() >= 5);
  for (const std::filesystem::path& path : cases) {
    DYNAMIC_SECTION(path.filename().string()) {
      Bench bench;
      REQUIRE(bench.tools.set(1, {.length = 10, .description = {}}));
      REQUIRE(bench.tools.set(3, {.length = 25.4, .description = {}}));
      const Outcome outcome = bench.run(read_file((path / "program.ngc").string()));
      std::string text;
      for (const std::string& line : outcome.lines) text += line + "\n";
      if (outcome.failed) text += outcome.diagnostic.to_string();
      CHECK(text == read_file((path / "expected.txt").string()));
    }
  }
}
