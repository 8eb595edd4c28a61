// The folder of a machine's configuration and state (CFG-1, STA-9).
#include "server/daemon/data_folder.h"

#include <catch2/catch.hpp>

#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::server;
using config::test::content_of;
using config::test::put;
using config::test::TemporaryDirectory;

TEST_CASE("The first start fills the folder with the shipped files", "[CFG-1]") {
  const TemporaryDirectory parent;
  const auto folder = parent.file("deep/cnc");
  const auto opened = DataFolder::open(folder);
  REQUIRE(opened);
  const auto shipped = [](const char* name) {
    return content_of(std::filesystem::path(CNC_SOURCE_DIR) / "config" / name);
  };
  CHECK(content_of(folder / "cnc.ini") == shipped("cnc.ini"));
  CHECK(content_of(folder / "parameters.txt") == shipped("default_parameters.txt"));
  CHECK(content_of(folder / "tools.txt") == shipped("default_tools.txt"));
  const auto data = opened->load({}, {});
  REQUIRE(data);
  CHECK(data->parameter_file == folder / "parameters.txt");
  CHECK(data->config.axes[Axis::X].positive_limit == 600.0);
}

TEST_CASE("A later start leaves the operator's files as they are", "[CFG-1][STA-9]") {
  const TemporaryDirectory folder;
  static_cast<void>(DataFolder::open(folder.path()));
  put(folder.file("parameters.txt"), "5221 12.5\n");
  const auto opened = DataFolder::open(folder.path());
  REQUIRE(opened);
  CHECK(content_of(folder.file("parameters.txt")) == "5221 12.5\n");
  const auto data = opened->load({}, {});
  REQUIRE(data);
  CHECK(data->parameters.work_offset(1)[Axis::X] == 12.5);
}

TEST_CASE("One server at a time uses a folder", "[STA-9]") {
  const TemporaryDirectory folder;
  {
    const auto first = DataFolder::open(folder.path());
    REQUIRE(first);
    const auto second = DataFolder::open(folder.path());
    REQUIRE_FALSE(second);
    CHECK(second.error().code == ErrorCode::already_running);
    CHECK_THAT(second.error().message, Catch::Contains(folder.path().string()));
  }
  CHECK(DataFolder::open(folder.path()));  // the first has gone
}

TEST_CASE("A wrong cnc.ini is refused with file and line, every error at once", "[CFG-1]") {
  const TemporaryDirectory folder;
  const auto opened = DataFolder::open(folder.path());
  REQUIRE(opened);
  put(folder.file("cnc.ini"), "[AXIS_X]\nport = nine\nvelocitty = 3\n");
  put(folder.file("tools.txt"), "100 0 0 0 9 beyond the table\n");
  const auto data = opened->load({}, {});
  REQUIRE_FALSE(data);
  REQUIRE(data.error().size() == 3);
  CHECK(data.error()[0].place->file == folder.file("cnc.ini").string());
  CHECK(data.error()[0].place->line == 2);
  CHECK(data.error()[1].place->line == 3);
  CHECK(data.error()[2].place->file == folder.file("tools.txt").string());
}

TEST_CASE("Another configuration file and single settings can be given at the start", "[CFG-1]") {
  const TemporaryDirectory folder;
  const auto opened = DataFolder::open(folder.path());
  REQUIRE(opened);
  put(folder.file("other.ini"), content_of(folder.file("cnc.ini")));
  const std::vector<std::string> settings{"AXIS_X.positiveLimit=123"};
  const auto data = opened->load(folder.file("other.ini"), settings);
  REQUIRE(data);
  CHECK(data->config.axes[Axis::X].positive_limit == 123.0);
}

TEST_CASE("A folder that cannot be made is an error that names it", "[CFG-1]") {
  const TemporaryDirectory folder;
  put(folder.file("file"), "no folder");
  const auto opened = DataFolder::open(folder.file("file/below"));
  REQUIRE_FALSE(opened);
  CHECK(opened.error().code == ErrorCode::file_not_writable);
  CHECK_THAT(opened.error().message, Catch::Contains("file/below"));
}
