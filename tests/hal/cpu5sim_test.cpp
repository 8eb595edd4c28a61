// A board in another process, by UDP and by a serial line: real time, real sockets.
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>
#include <unistd.h>

#include "hal/cpu5/driver/board_address.h"
#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/cpu5/driver/wire_port.h"
#include "tests/hal/machine_support.h"
#include "tests/patience.h"
#include "tests/process.h"

namespace cnc::hal::sim {

namespace {

using cnc::test::kPatience;
using cnc::test::Process;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kCycle{2};

std::filesystem::path folder() {
  const auto path =
      std::filesystem::temp_directory_path() / ("cpu5sim_" + std::to_string(::getpid()));
  std::filesystem::create_directories(path);
  return path;
}

/// cpu5sim on a free port and with a serial line.
class Simulator {
 public:
  explicit Simulator(const std::vector<std::string>& more = {})
      : process_(arguments(more), (folder() / ("cpu5sim" + std::to_string(++count()))).string()) {
    const auto until = Clock::now() + kPatience;
    while (process_.out().find('\n') == std::string::npos) {
      REQUIRE(Clock::now() < until);
      std::this_thread::sleep_for(kCycle);
    }
  }

  [[nodiscard]] static std::string serial() { return "serial:" + (folder() / "board").string(); }
  [[nodiscard]] std::string udp() const {
    const std::string line = process_.out();
    const auto begin = line.find("udp:");
    return line.substr(begin, line.find_first_of(" \n", begin) - begin);
  }
  void kill() const { process_.signal(SIGKILL); }

 private:
  /// So that none reads what an earlier one has printed.
  static int& count() {
    static int simulators = 0;
    return simulators;
  }
  static std::vector<std::string> arguments(const std::vector<std::string>& more) {
    std::vector<std::string> all{CPU5SIM, "--port", "0", "--pty", (folder() / "board").string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  Process process_;
};

class Host {
 public:
  explicit Host(const std::string& address) {
    auto channel = cpu5::make_channel(address);
    REQUIRE(channel);
    auto port = std::make_unique<cpu5::WirePort>(std::move(*channel), cpu5::WireSettings{});
    driver = std::make_unique<cpu5::Cpu5Driver>(small_machine(), cpu5::DriverSettings{},
                                                std::move(port));
  }

  const ControllerStatus& cycle() {
    std::this_thread::sleep_for(kCycle);
    return driver->exchange(std::chrono::duration<double>(Clock::now().time_since_epoch()).count());
  }
  template <typename Condition>
  bool becomes(Condition condition) {
    const auto until = Clock::now() + kPatience;
    while (Clock::now() < until) {
      if (condition(cycle())) return true;
    }
    return false;
  }
  /// To 40 mm and back, twice, in segments of 10 ms; the board has up to two seconds of them, so
  /// that a busy computer starves nobody.
  void run_job() {
    constexpr std::uint32_t kSegments = 400;
    std::uint32_t pushed = 0;
    REQUIRE(becomes([&](const ControllerStatus& status) {
      while (pushed < kSegments && status.fifo_time < 2.0) {
        const double angle = 2.0 * M_PI * (pushed + 1) / 200.0;
        Segment segment{.id = pushed + 1, .duration = 0.01};
        segment.position[Axis::X] = 20.0 * (1.0 - std::cos(angle));
        segment.velocity[Axis::X] =
            pushed + 1 == kSegments ? 0.0 : 20.0 * M_PI / 1.0 * std::sin(angle);
        if (driver->push({&segment, 1}) != 1) break;
        ++pushed;
        if (pushed % 10 == 0) break;
      }
      return status.faults != 0 || (status.executing_id == kSegments && !status.moving);
    }));
  }

  std::unique_ptr<cpu5::Cpu5Driver> driver;
};

}  // namespace

TEST_CASE("A job runs on a board behind a socket, and behind a serial line",
          "[hal][LNK-1][LNK-9]") {
  const Simulator simulator;
  const bool by_serial = GENERATE(false, true);
  Host host(by_serial ? Simulator::serial() : simulator.udp());
  if (const auto connected = host.driver->connect(); !connected)
    FAIL(connected.error().to_string());
  host.driver->set_outputs({.drives_enabled = true});
  host.run_job();
  CHECK(host.cycle().faults == 0);
  CHECK(host.cycle().position[Axis::X] == Approx(0.0).margin(1e-9));
  host.driver->disconnect();
}

TEST_CASE("A job over a bad network takes every step", "[hal][LNK-4][LNK-9]") {
  const Simulator simulator({"--loss", "0.05", "--jitter", "0.02"});
  Host host(simulator.udp());
  if (const auto connected = host.driver->connect(); !connected)
    FAIL(connected.error().to_string());
  host.run_job();
  CHECK(host.cycle().faults == 0);
  CHECK(host.cycle().position[Axis::X] == Approx(0.0).margin(1e-9));
}

TEST_CASE("A second host is told that the board is taken", "[hal][LNK-9]") {
  const Simulator simulator;
  Host first(simulator.udp());
  if (const auto connected = first.driver->connect(); !connected)
    FAIL(connected.error().to_string());
  std::atomic<bool> done{false};
  std::thread alive([&] {
    while (!done) first.cycle();
  });
  Host second(Simulator::serial());
  const auto refused = second.driver->connect();
  done = true;
  alive.join();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::board_busy);
}

TEST_CASE("A host that goes leaves the board to the next at once", "[hal][LNK-9]") {
  const Simulator simulator;
  for (int i = 0; i < 3; ++i) {
    Host host(simulator.udp());
    const auto begin = Clock::now();
    REQUIRE(host.driver->connect());
    // A host that is only silent keeps the board for a second.
    CHECK(Clock::now() - begin < std::chrono::milliseconds(900));
  }
}

TEST_CASE("A board that died is missed", "[hal][LNK-4][LNK-9]") {
  const Simulator simulator;
  Host host(simulator.udp());
  if (const auto connected = host.driver->connect(); !connected)
    FAIL(connected.error().to_string());
  REQUIRE(host.cycle().connected);
  simulator.kill();
  REQUIRE(host.becomes([](const ControllerStatus& status) { return !status.connected; }));
}

TEST_CASE("A board in the place of one that died is found, and its counts are its own",
          "[hal][LNK-4][LNK-9]") {
  auto simulator = std::make_unique<Simulator>();
  Host host(Simulator::serial());
  REQUIRE(host.driver->connect());
  REQUIRE(host.cycle().connected);
  simulator.reset();
  REQUIRE(host.becomes([](const ControllerStatus& status) { return !status.connected; }));
  simulator = std::make_unique<Simulator>();
  REQUIRE(host.becomes([](const ControllerStatus& status) { return status.connected; }));
  CHECK(host.cycle().sessions == 2);
  CHECK(host.cycle().counts_lost);
}

TEST_CASE("An address that is none says what one looks like", "[hal][LNK-1]") {
  for (const char* wrong :
       {"", "com3", "udp:host:0", "udp:host:99999", "udp:host:x", "serial:/dev/ttyUSB0@",
        "serial:/dev/ttyUSB0@115200", "serial:/dev/ttyUSB0@921600", "serial:/dev/ttyUSB0@2000000n",
        "serial:/dev/ttyUSB0@1999999", "serial:/dev/ttyUSB0@2500000"}) {
    CAPTURE(wrong);
    const auto channel = cpu5::make_channel(wrong);
    REQUIRE_FALSE(channel);
    CHECK(channel.error().code == ErrorCode::board_address_wrong);
  }
  CHECK(cpu5::make_channel("serial:/dev/ttyUSB0@2500000")
            .error()
            .message.find("2000000, 3000000, 3500000, 4000000") != std::string::npos);
  // What is behind the colons of a name is no rate; what is behind the @ is no name.
  const auto by_path = cpu5::make_channel("serial:/dev/serial/by-path/usb-0:1:1.0@3000000");
  REQUIRE(by_path);
  CHECK((*by_path)->open().error().message.find("serial:/dev/serial/by-path/usb-0:1:1.0 cannot") ==
        0);
  auto nowhere = cpu5::make_channel("serial:/dev/there_is_none");
  REQUIRE(nowhere);
  const auto opened = (*nowhere)->open();
  REQUIRE_FALSE(opened);
  CHECK(opened.error().code == ErrorCode::board_line_unusable);
}

}  // namespace cnc::hal::sim
