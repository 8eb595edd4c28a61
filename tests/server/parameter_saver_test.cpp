// Parameters are written on a thread of their own (STA-9).
#include <catch2/catch.hpp>

#include "server/machine/persistence.h"
#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::server;
using config::test::TemporaryDirectory;

namespace {

config::ParameterStore with(double value) {
  config::ParameterStore parameters;
  parameters.set(4000, value);
  return parameters;
}

double stored_in(const std::filesystem::path& file) {
  return config::ParameterStore::load(file).value().get(4000);
}

}  // namespace

TEST_CASE("What was handed over is on disk when wait() returns", "[STA-9][threads]") {
  const TemporaryDirectory folder;
  MessageLog log;
  StateSaver saver({folder.file("parameters.txt"), {}}, log);
  for (int i = 1; i <= 50; ++i) saver.save(with(i), {});
  saver.wait();
  CHECK(stored_in(folder.file("parameters.txt")) == 50.0);
  CHECK(log.newest() == 0);
}

TEST_CASE("The destructor writes what still waits", "[STA-9][threads]") {
  const TemporaryDirectory folder;
  MessageLog log;
  {
    StateSaver saver({folder.file("parameters.txt"), {}}, log);
    saver.save(with(7.0), {});
  }
  CHECK(stored_in(folder.file("parameters.txt")) == 7.0);
}

TEST_CASE("A file that cannot be written is an error in the log, and the next save is tried",
          "[STA-9][threads]") {
  const TemporaryDirectory folder;
  MessageLog log;
  StateSaver saver({folder.file("missing/parameters.txt"), {}}, log);
  saver.save(with(1.0), {});
  saver.wait();
  REQUIRE(log.newest() == 1);
  CHECK(log.after(0)[0].error->code == ErrorCode::file_not_writable);
  std::filesystem::create_directory(folder.file("missing"));
  saver.save(with(2.0), {});
  saver.wait();
  CHECK(stored_in(folder.file("missing/parameters.txt")) == 2.0);
}

TEST_CASE("A simulation saves nothing", "[threads]") {
  MessageLog log;
  StateSaver saver({}, log);
  saver.save(with(1.0), {});
  saver.wait();
  CHECK(log.newest() == 0);
}

TEST_CASE("Tools are written when they change, beside the parameters", "[STA-9][threads]") {
  const TemporaryDirectory folder;
  MessageLog log;
  StateSaver saver({folder.file("parameters.txt"), folder.file("tools.txt")}, log);
  config::ToolTable tools;
  REQUIRE(tools.set(7, {.length = 42.5}));
  saver.save(with(3.0), tools);
  saver.wait();
  CHECK(stored_in(folder.file("parameters.txt")) == 3.0);
  CHECK(config::ToolTable::load(folder.file("tools.txt")).value().tool(7).length == 42.5);
}
