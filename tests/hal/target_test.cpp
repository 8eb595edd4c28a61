// The firmware on a Cortex-M3, emulated, driven by the real driver over UDP: real sockets and a
// real clock. The emulator counts instructions (-icount), so what the board measures can be
// repeated.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/cpu5/driver/udp_channel.h"
#include "hal/cpu5/driver/wire_port.h"
#include "tests/process.h"

namespace cnc::hal::cpu5 {
namespace {

constexpr int kShift = 3;  // an instruction takes 2^3 ns of the board's time
constexpr int kCountNanoseconds = 40;
constexpr double kStepsPerUnit = 200.0;
constexpr double kPiece = 0.01;

/// Free now, and so it will be a moment later.
std::uint16_t free_port() {
  boost::asio::io_context context;
  const boost::asio::ip::udp::endpoint any(boost::asio::ip::address_v4::loopback(), 0);
  return boost::asio::ip::udp::socket(context, any).local_endpoint().port();
}

/// An emulated board, as fast as a Cortex-M with 125 MHz.
class Board {
 public:
  explicit Board(const std::string& name) : process_(command(), name) {}

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// The number at the end of the line that begins with `text` on the board's UART, when it has
  /// been written within a few seconds.
  [[nodiscard]] std::optional<int> number_behind(const std::string& text) const {
    for (int i = 0; i < 500; ++i) {
      const std::string log = process_.out();
      const auto line = log.find(text);
      const auto end = line == std::string::npos ? line : log.find('\r', line);
      if (end != std::string::npos) return std::stoi(log.substr(log.rfind(' ', end)));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return {};
  }

 private:
  [[nodiscard]] std::vector<std::string> command() const {
    return {QEMU_ARM,
            "-M",
            "mps2-an385",
            "-icount",
            "shift=" + std::to_string(kShift) + ",sleep=on",
            "-kernel",
            MPS2_IMAGE,
            "-display",
            "none",
            "-monitor",
            "none",
            "-serial",
            "stdio",
            "-nic",
            "user,model=lan9118,net=172.22.2.0/24,hostfwd=udp:127.0.0.1:" + std::to_string(port_) +
                "-" + kBoardAddress + ":" + std::to_string(kBoardPort)};
  }

  std::uint16_t port_ = free_port();
  test::Process process_;
};

config::MachineConfig six_axes() {
  config::MachineConfig config;
  std::int32_t port = 0;
  for (const Axis axis : kAllAxes) {
    config.axes[axis].port = ++port;
    config.axes[axis].steps_per_unit = kStepsPerUnit;
  }
  return config;
}

/// Six axes on cosines of one second, from rest to rest, `reach` to one side.
class Job {
 public:
  Job(Controller& controller, const Position& reach) : controller_(controller), reach_(reach) {}

  /// Runs as many half seconds of it: an odd number ends at `reach`.
  void run(std::uint32_t halves) {
    const std::uint32_t last = halves * static_cast<std::uint32_t>(0.5 / kPiece);
    const ControllerStatus* status = &exchange();
    for (int i = 0; i < 1000 && !status->connected; ++i) {  // until its first answer is there
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      status = &exchange();
    }
    while (status->executing_id != last || status->moving) {
      while (next_ <= last) {
        const Segment piece = segment(next_);
        if (controller_.push({&piece, 1}) != 1) break;
        ++next_;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      status = &exchange();
      REQUIRE(status->faults == 0);
      REQUIRE(status->connected);
    }
  }
  const ControllerStatus& exchange() {
    const std::chrono::duration<double> now = std::chrono::steady_clock::now().time_since_epoch();
    return controller_.exchange(now.count());
  }

 private:
  [[nodiscard]] Segment segment(std::uint32_t number) const {
    const double angle = 2.0 * M_PI * number * kPiece;
    Segment piece{.id = number, .duration = kPiece};
    for (const Axis axis : kAllAxes) {
      piece.position[axis] = reach_[axis] * (1.0 - std::cos(angle)) / 2;
      piece.velocity[axis] = reach_[axis] * M_PI * std::sin(angle);
    }
    const auto whole = static_cast<std::uint32_t>(0.5 / kPiece);
    if (number % whole == 0) piece.velocity = {};  // sin(n pi) is not quite 0
    return piece;
  }

  Controller& controller_;
  Position reach_;
  std::uint32_t next_ = 1;
};

Cpu5Driver driver_of(const Board& board) {
  return {six_axes(),
          {.host_timeout = 10.0},
          std::make_unique<WirePort>(std::make_unique<UdpChannel>("127.0.0.1", board.port()),
                                     WireSettings{.silence = 10.0})};
}

/// One attempt takes a second; an emulator on a busy computer may need more to start.
bool connect(Controller& driver) {
  for (int i = 0; i < 10; ++i) {
    if (driver.connect()) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("A whole job on the emulated board ends with exact step counts", "[hal][target][LNK-1]") {
  const Board board("target_job");
  Cpu5Driver driver = driver_of(board);
  REQUIRE(connect(driver));
  const Position reach{.values = {20.0, -10.0, 5.0, 30.0, -0.5, 12.345}};
  Job job(driver, reach);
  job.run(7);
  // All of them whole steps: 4000, -2000, 1000, 6000, -100, 2469.
  const ControllerStatus& end = job.exchange();
  for (const Axis axis : kAllAxes) {
    CHECK(end.position[axis] * kStepsPerUnit == Approx(reach[axis] * kStepsPerUnit).margin(1e-6));
  }
}

TEST_CASE("The step interrupt stays short when six axes step at once, and look at their switches",
          "[hal][target]") {
  const Board board("target_interrupt");
  Cpu5Driver driver = driver_of(board);
  REQUIRE(connect(driver));
  for (const Axis axis : kAllAxes) driver.arm_home_latch(axis, LatchEdge::activate);
  Job job(driver, Position::filled(5.0));
  job.run(3);
  CHECK(job.exchange().position[Axis::C] == Approx(5.0));
  driver.disconnect();
  const std::optional<int> counts = board.number_behind("step interrupt, longest");
  REQUIRE(counts);
  const int instructions = *counts * kCountNanoseconds / (1 << kShift);
  WARN("longest step interrupt: " << instructions << " instructions");
  CHECK(instructions < 2500);
}

}  // namespace cnc::hal::cpu5
