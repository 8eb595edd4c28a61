// cpu5sim: a virtual CPU5 board with its machine, reachable as a real one is.
#include <CLI/CLI.hpp>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fmt/core.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "config/ini_file.h"
#include "hal/cpu5/driver/udp_channel.h"
#include "hal/cpu5/wire/cobs.h"
#include "hal/sim/posted_board.h"

namespace cnc::hal::sim {
namespace {

using boost::asio::ip::udp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// The board is given its time at least so often.
constexpr int kTickMilliseconds = 1;
/// Packets that are taken at one look; what else has come waits for the next.
constexpr std::size_t kMostFound = 4096;

volatile std::sig_atomic_t stopped = 0;

struct Options {
  std::filesystem::path config;
  std::vector<std::string> settings;
  std::string address = "127.0.0.1";
  std::uint16_t port = cpu5::kBoardPort;
  std::filesystem::path pty;
  std::filesystem::path scenario;
  LinkTrouble trouble;  ///< where there is no scenario
};

int report(const std::string& message) {
  fmt::print(stderr, "cpu5sim: {}\n", message);
  return EXIT_FAILURE;
}

/// A line that a program can open as if a board were behind it.
class Pty {
 public:
  /// `link`: name that leads to it, replaced if it is a link already.
  bool open(const std::filesystem::path& link) {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0) return false;
    termios raw{};
    ::tcgetattr(master_, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(master_, TCSANOW, &raw);
    // Held open, so that a host that goes does not hang up the line for the next one.
    slave_ = ::open(::ptsname(master_), O_RDWR | O_NOCTTY);
    std::error_code wrong;
    if (std::filesystem::is_symlink(link, wrong)) std::filesystem::remove(link, wrong);
    std::filesystem::create_symlink(::ptsname(master_), link, wrong);
    link_ = link;
    return slave_ >= 0 && !wrong;
  }
  ~Pty() {
    std::error_code ignored;
    if (!link_.empty()) std::filesystem::remove(link_, ignored);
    if (slave_ >= 0) ::close(slave_);
    if (master_ >= 0) ::close(master_);
  }
  Pty() = default;
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  [[nodiscard]] int handle() const { return master_; }

  /// take(packet) for each one that has come.
  template <typename Take>
  void receive(Take take) {
    std::array<std::uint8_t, 4096> bytes;
    for (;;) {
      const auto size = ::read(master_, bytes.data(), bytes.size());
      if (size <= 0) return;
      for (const std::uint8_t byte : std::span(bytes).first(static_cast<std::size_t>(size))) {
        if (reader_.take(byte)) take(reader_.packet());
      }
    }
  }
  void send(std::span<const std::uint8_t> packet) {
    std::array<std::uint8_t, cpu5::wire::cobs_size(cpu5::wire::kMaxPacket)> line;
    const std::size_t size = cpu5::wire::write_cobs(packet, line);
    // A line that is full loses the rest: the packet's CRC tells.
    static_cast<void>(!::write(master_, line.data(), size));
  }

 private:
  int master_ = -1;
  int slave_ = -1;
  std::filesystem::path link_;
  cpu5::wire::CobsReader<cpu5::wire::kMaxPacket> reader_;
};

/// The board, its clock and its lines.
class Simulator {
 public:
  Simulator(const config::MachineConfig& config, const Scenario& scenario)
      : board_(config, scenario, [this](std::span<const std::uint8_t> packet) { send(packet); }) {}

  Result<void> listen(const std::string& address, std::uint16_t port) {
    error_code wrong;
    const auto ip = boost::asio::ip::make_address_v4(address, wrong);
    if (!wrong) socket_.open(udp::v4(), wrong);
    if (!wrong) socket_.bind({ip, port}, wrong);
    if (!wrong) socket_.non_blocking(true, wrong);
    if (!wrong) return {};
    return fail(ErrorCode::board_line_unusable,
                fmt::format("Port {} of {} cannot be used: {}.", port, address, wrong.message()));
  }
  bool open_pty(const std::filesystem::path& link) { return pty_.open(link); }
  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }

  void run() {
    while (stopped == 0) {
      std::array<pollfd, 2> waiting{pollfd{socket_.native_handle(), POLLIN, 0},
                                    pollfd{pty_.handle(), POLLIN, 0}};
      ::poll(waiting.data(), pty_.handle() >= 0 ? 2 : 1, kTickMilliseconds);
      found_.clear();
      receive();
      board_.look(now(), found_);
    }
  }

 private:
  enum class Way : std::uint8_t { udp, pty };

  [[nodiscard]] double now() const {
    return std::chrono::duration<double>(Clock::now() - power_up_).count();
  }

  void receive() {
    std::array<std::uint8_t, cpu5::wire::kMaxPacket> memory;
    while (found_.size() < kMostFound) {
      error_code nothing;
      udp::endpoint from;
      const auto size = socket_.receive_from(boost::asio::buffer(memory), from, 0, nothing);
      if (nothing) break;
      peer_ = from;
      way_ = Way::udp;
      found_.emplace_back(memory.begin(), memory.begin() + static_cast<std::ptrdiff_t>(size));
    }
    if (pty_.handle() < 0) return;
    pty_.receive([&](std::span<const std::uint8_t> packet) {
      way_ = Way::pty;
      found_.emplace_back(packet.begin(), packet.end());
    });
  }

  void send(std::span<const std::uint8_t> packet) {
    if (way_ == Way::pty) return pty_.send(packet);
    error_code lost;
    socket_.send_to(boost::asio::buffer(packet.data(), packet.size()), peer_, 0, lost);
  }

  PostedBoard board_;
  std::vector<PostedBoard::Packet> found_;
  boost::asio::io_context context_;
  udp::socket socket_{context_};
  udp::endpoint peer_;
  Pty pty_;
  Way way_ = Way::udp;  // the last packet came
  Clock::time_point power_up_ = Clock::now();
};

int simulate(const Options& options) {
  const auto config = options.config.empty()
                          ? config::parse_machine_config("", "no file", options.settings)
                          : config::load_machine_config(options.config, options.settings);
  if (!config) {
    for (const Error& error : config.error()) report(error.to_string());
    return EXIT_FAILURE;
  }
  Scenario scenario{.link = options.trouble};
  if (!options.scenario.empty()) {
    auto loaded = load_scenario(options.scenario);
    if (!loaded) return report(loaded.error().to_string());
    scenario = std::move(*loaded);
  }
  Simulator simulator(*config, scenario);
  if (auto listening = simulator.listen(options.address, options.port); !listening) {
    return report(listening.error().to_string());
  }
  if (!options.pty.empty() && !simulator.open_pty(options.pty)) {
    return report(fmt::format("The serial line {} cannot be made.", options.pty.string()));
  }
  fmt::print("A CPU5 board at udp:{}:{}{}\n", options.address, simulator.port(),
             options.pty.empty() ? "" : fmt::format(" and serial:{}", options.pty.string()));
  std::fflush(stdout);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { stopped = 1; });
  simulator.run();
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace cnc::hal::sim

int main(int argc, char** argv) {
  using namespace cnc::hal::sim;
  Options options;
  CLI::App app{
      "cpu5sim: a virtual CPU5 board with its machine, reachable by UDP and by a serial line, as a "
      "real one is. It ends with Ctrl-C."};
  app.add_option("--config", options.config,
                 "Configuration file of the machine behind the board; without it no motor is "
                 "connected")
      ->check(CLI::ExistingFile);
  app.add_option("--set", options.settings,
                 "Overrides a setting: SECTION.key=value; may be repeated");
  app.add_option("--address", options.address, "Address to listen at")->capture_default_str();
  app.add_option("--port", options.port, "UDP port; 0 takes any free one")->capture_default_str();
  app.add_option("--pty", options.pty, "Name for a serial line that leads to the board");
  auto* scenario = app.add_option("--scenario", options.scenario,
                                  "How the machine is built and what happens to it: "
                                  "docs/scenarios.md")
                       ->check(CLI::ExistingFile);
  const auto probability = CLI::Range(0.0, 1.0);
  app.add_option("--loss", options.trouble.loss, "Part of the packets that is lost")
      ->check(probability)
      ->excludes(scenario);
  app.add_option("--duplication", options.trouble.duplication, "Part that comes twice")
      ->check(probability)
      ->excludes(scenario);
  app.add_option("--corruption", options.trouble.corruption, "Part that is damaged")
      ->check(probability)
      ->excludes(scenario);
  app.add_option("--delay", options.trouble.delay, "Seconds that every packet takes")
      ->check(CLI::Range(0.0, 10.0))
      ->excludes(scenario);
  app.add_option("--jitter", options.trouble.jitter, "Seconds that it may take longer")
      ->check(CLI::Range(0.0, 10.0))
      ->excludes(scenario);
  CLI11_PARSE(app, argc, argv);
  return simulate(options);
}
