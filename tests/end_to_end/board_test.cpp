// A server and its board as two processes: cpu5sim behind a socket and behind a serial line.
#include <catch2/catch.hpp>
#include <csignal>
#include <thread>

#include "tests/end_to_end/test_server.h"

using namespace cnc;
using namespace cnc::api;
using namespace cnc::test;
using namespace std::chrono_literals;

namespace {

constexpr const char* kBusy =
    "G53 G0 X5 Y5\nG91\nG1 X20 F3000\nG3 X10 Y10 J10\nG1 X-30.005 Y-10\nM30\n";

/// A cpu5sim that can be switched off and on again, at the same addresses.
class SwitchedBoard {
 public:
  explicit SwitchedBoard(const ServerFolder& folder) : folder_(folder) {}

  void switch_on() {
    const std::string output = folder_.file("board" + std::to_string(++starts_));
    std::vector<std::string> arguments{
        CPU5SIM, "--config", CNC_SOURCE_DIR "/config/cnc.ini", "--port", port_, "--pty", line()};
    for (const std::string& argument : small_machine()) arguments.push_back(argument);
    process_ = std::make_unique<Process>(arguments, output);
    const auto until = std::chrono::steady_clock::now() + kPatience;
    while (process_->out().find('\n') == std::string::npos) {
      INFO(process_->err());
      REQUIRE(std::chrono::steady_clock::now() < until);
      std::this_thread::sleep_for(2ms);
    }
    const std::string said = process_->out();
    const auto begin = said.find("udp:127.0.0.1:") + std::string("udp:127.0.0.1:").size();
    port_ = said.substr(begin, said.find(' ', begin) - begin);
  }
  /// As if its power failed.
  void switch_off() {
    process_->signal(SIGKILL);
    REQUIRE(process_->exit_code(kPatience) == 128 + SIGKILL);
  }

  [[nodiscard]] std::string udp() const { return "udp:127.0.0.1:" + port_; }
  [[nodiscard]] std::string serial() const { return "serial:" + line(); }

 private:
  [[nodiscard]] std::string line() const { return folder_.file("line"); }

  const ServerFolder& folder_;
  std::string port_ = "0";
  int starts_ = 0;
  std::unique_ptr<Process> process_;
};

std::vector<std::string> machine_at(const std::string& board,
                                    const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = small_machine();
  for (const char* axis : {"X", "Y", "Z"})  // homed by hand, which takes no time
    arguments.insert(arguments.end(), {"--set", std::string("AXIS_") + axis + ".homeVelocity=0"});
  // A simulator that a busy computer keeps waiting for a moment is no fault of the server's.
  for (const char* patient : {"CONNECTION.hostTimeout=1", "TRAJECTORY.fifoTime=1.2"})
    arguments.insert(arguments.end(), {"--set", patient});
  arguments.insert(arguments.end(), {"--board", board});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// Comes to its end, at the very step: 200 steps/mm.
void check_job(RunningServer& server) {
  server.start_job(kBusy);
  // 5 + 20 + 10 - 30.005 and 5 + 10 - 10; 0.005 mm are one step.
  const bool has_ended = server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::ready && status.machine_position[Axis::X] > 4.0;
  });
  INFO(server.process.out());
  REQUIRE(has_ended);
  CHECK(server.watcher.newest().machine_position[Axis::X] == Approx(4.995).margin(1e-9));
  CHECK(server.watcher.newest().machine_position[Axis::Y] == Approx(5.0).margin(1e-9));
}

}  // namespace

TEST_CASE("A server finds its board again after it was off, and jobs run before and after",
          "[LNK-1][LNK-4][ARC-4][e2e]") {
  const bool by_serial = GENERATE(false, true);
  const ServerFolder folder;
  SwitchedBoard board(folder);
  board.switch_on();
  RunningServer server(folder, machine_at(by_serial ? board.serial() : board.udp()));
  server.make_ready();
  check_job(server);

  board.switch_off();
  REQUIRE(server.watcher.sees(MachineState::off));
  board.switch_on();
  // It has lost its counts: nothing moves before the operator has reset and homed.
  REQUIRE(server.watcher.sees(MachineState::error));
  CHECK(server.watcher.newest().homed == AxisFlags{});
  server.make_ready();
  check_job(server);
}

TEST_CASE("A server that is started before its board waits for it", "[LNK-1][LNK-4][e2e]") {
  const bool by_serial = GENERATE(false, true);
  const ServerFolder folder;
  SwitchedBoard board(folder);
  board.switch_on();  // for a port that is free
  board.switch_off();
  const Process server = folder.start(machine_at(by_serial ? board.serial() : board.udp()));
  const Client client = Client::without_connecting(folder.address());
  Watcher watcher(client);
  REQUIRE(watcher.sees(MachineState::off));
  board.switch_on();
  CHECK(watcher.sees(MachineState::needs_reset));
}

TEST_CASE("An address that no board can have keeps the server from starting", "[LNK-1][e2e]") {
  const ServerFolder folder;
  Process server = folder.start({"--board", "com3"});
  CHECK(server.exit_code(kPatience) == 1);
  CHECK_THAT(server.err(), Catch::Contains("\"com3\" is no address of a board"));
}

TEST_CASE("A server that is to end with its board saves and ends when the board is lost",
          "[STA-9][LNK-4][e2e]") {
  const ServerFolder folder;
  SwitchedBoard board(folder);
  board.switch_on();
  RunningServer server(folder, machine_at(board.udp(), {"--set", "SAFETY.shutDownOnFatal=1"}));
  server.make_ready();
  server.start_job("G53 G0 X0\nG10 L2 P3 Y-4\nG91 G1 X70 F300\nM30\n");
  REQUIRE(server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::running && status.machine_position[Axis::X] > 1.0;
  }));
  board.switch_off();
  CHECK(server.process.exit_code(kPatience) == 0);
  CHECK_FALSE(std::filesystem::exists(folder.socket()));
  CHECK_THAT(config::test::content_of(folder.data() + "/parameters.txt"),
             Catch::Contains("5262 -4"));  // Y of system 3: 5221 + 2 · 20 + 1
}
