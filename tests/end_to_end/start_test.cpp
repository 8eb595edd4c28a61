// When a server does not start (CFG-1, STA-9).
#include <catch2/catch.hpp>

#include "tests/end_to_end/test_server.h"

using namespace cnc;
using namespace cnc::test;
using Catch::Contains;

TEST_CASE("A second server on the same data folder is refused, the first is not disturbed",
          "[STA-9][e2e]") {
  const ServerFolder folder;
  const RunningServer first(folder);
  Process second({CNCSERVER, "--data", folder.data(), "--socket", folder.file("other"), "--listen",
                  "127.0.0.1:0"},
                 folder.file("second"));
  CHECK(second.exit_code(kPatience) == 1);
  CHECK_THAT(second.err(), Contains("Another server uses") && Contains(folder.data()));
  CHECK(first.client.version());
}

TEST_CASE("A wrong cnc.ini keeps the server from starting, with file and line", "[CFG-1][e2e]") {
  const ServerFolder folder;
  std::filesystem::create_directory(folder.data());
  config::test::put(folder.data() + "/cnc.ini",
                    "[AXIS_X]\nport = 1\nvelocity = quick\n\n[AXIS_Q]\n");
  Process server = folder.start({});
  CHECK(server.exit_code(kPatience) == 1);
  CHECK_THAT(server.err(), Contains(folder.data() + "/cnc.ini:3") && Contains("quick") &&
                               Contains(folder.data() + "/cnc.ini:5"));
}

TEST_CASE("A wrong setting of the command line keeps the server from starting", "[CFG-1][e2e]") {
  const ServerFolder folder;
  Process server = folder.start({"--set", "AXIS_X.velocity=-3"});
  CHECK(server.exit_code(kPatience) == 1);
  CHECK_THAT(server.err(), Contains("velocity") && Contains("-3"));
}

TEST_CASE("An address that cannot be listened on keeps the server from starting", "[ARC-1][e2e]") {
  const ServerFolder folder;
  Process server = folder.start({"--listen", "192.0.2.1:1"});  // TEST-NET-1: nobody's
  CHECK(server.exit_code(kPatience) == 1);
  CHECK_THAT(server.err(), Contains("192.0.2.1:1"));
}

TEST_CASE("Only its owner may use the server's socket", "[ARC-5][e2e]") {
  const ServerFolder folder;
  const RunningServer server(folder);
  using std::filesystem::perms;
  const perms rights = std::filesystem::status(folder.socket()).permissions();
  CHECK((rights & (perms::group_all | perms::others_all)) == perms::none);
}

TEST_CASE("A client that waits for its server is connected soon after the start", "[ARC-1][e2e]") {
  const ServerFolder folder;
  Watcher watcher(api::Client::without_connecting(folder.address()));
  CHECK_FALSE(watcher.sees(api::MachineState::needs_reset, std::chrono::seconds(1)));
  const Process server = folder.start();
  // The client tries at least every 2 s; an attempt that hung would take much longer.
  CHECK(watcher.sees(api::MachineState::needs_reset, std::chrono::seconds(4)));
}
