// cncserver: the daemon that owns the machine.
#include <CLI/CLI.hpp>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "config/config_checks.h"
#include "hal/cpu5/driver/board_address.h"
#include "hal/cpu5/driver/wire_port.h"
#include "hal/sim/virtual_controller.h"
#include "hal/trace/traced_controller.h"
#include "server/daemon/data_folder.h"
#include "server/daemon/link_thread.h"
#include "server/daemon/real_time.h"
#include "server/daemon/task_thread.h"
#include "server/daemon/trace_keeper.h"
#include "server/link/link_trace.h"
#include "server/rpc/grpc_server.h"
#include "server/simulation/virtual_bench.h"
#include "server/version.h"

namespace cnc::server {
namespace {

constexpr std::chrono::microseconds kLinkPeriod{2000};
constexpr std::chrono::microseconds kMachinePeriod{5000};
constexpr std::chrono::seconds kStopTimeout{5};
constexpr const char* kTraceFolder = "traces";

struct Options {
  std::filesystem::path data = default_data_folder();
  std::filesystem::path config;
  std::filesystem::path jobs = std::filesystem::current_path();
  std::vector<std::string> settings;
  std::string board{};  // empty: as configured
  std::filesystem::path scenario;
  std::string socket;
  std::vector<std::string> listen{"127.0.0.1:50871"};
  std::string log_level = "info";
};

/// Where clients look when nobody tells them otherwise; libcncapi has the same rule.
std::string default_socket() {
  if (const char* run = std::getenv("XDG_RUNTIME_DIR"); run != nullptr && *run != '\0')
    if (std::error_code ignored; std::filesystem::is_directory(run, ignored))
      return fmt::format("{}/cncserver.sock", run);
  return fmt::format("/tmp/cncserver-{}.sock", ::getuid());
}

/// Only this user's programs may command the machine through the socket.
void protect_socket(const std::string& path) {
  std::error_code ignored;
  std::filesystem::permissions(
      path, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write, ignored);
}

void report(const config::Errors& errors) {
  for (const Error& error : errors)
    fmt::print(stderr, "cncserver: {}\n  {}\n", error.to_string(), error_info(error.code).check);
}

int report(const Error& error) {
  report(config::Errors{error});
  return EXIT_FAILURE;
}

/// Blocks until SIGTERM or SIGINT.
void wait_for_signal() {
  boost::asio::io_context context;
  boost::asio::signal_set signals(context, SIGTERM, SIGINT);
  signals.async_wait([](const boost::system::error_code&, int number) {
    spdlog::info("Signal {}: stopping.", number);
  });
  context.run();
}

/// Lets the machine come to rest and save; gives up after a while.
void stop_machine(TaskThread& executor, Machine& machine) {
  executor.post([&machine] { machine.shut_down(); });
  const auto deadline = std::chrono::steady_clock::now() + kStopTimeout;
  std::atomic<bool> done{false};
  while (!done && std::chrono::steady_clock::now() < deadline) {
    executor.post([&] { done = machine.is_shut_down(); });
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (!done) spdlog::warn("The machine did not come to rest in time.");
}

/// What the machine hangs on, and what can be done to it if it is only simulated.
struct Board {
  std::unique_ptr<hal::Controller> controller;
  std::string name;
  std::function<void(bool)> press_estop{};
};

Result<Board> make_virtual_board(const std::filesystem::path& scenario_file,
                                 const config::MachineConfig& config) {
  auto scenario = scenario_of(scenario_file, config);
  if (!scenario) return std::unexpected(scenario.error());
  auto controller =
      hal::sim::make_virtual_controller(config, {.machine = std::move(scenario->machine),
                                                 .driver = hal::cpu5::driver_settings(config),
                                                 .link = scenario->link,
                                                 .events = std::move(scenario->events)});
  auto& machine = controller->machine();
  return Board{std::move(controller), "virtual CPU5 board",
               [&machine](bool pressed) { machine.press_estop(pressed); }};
}

/// What becomes of the way to a real board is told as it happens.
Result<Board> make_board(const Options& options, const config::MachineConfig& config,
                         MessageLog& log) {
  const std::string& address = options.board.empty() ? config.connection.board : options.board;
  if (address == "virtual") return make_virtual_board(options.scenario, config);
  if (!options.scenario.empty())
    return fail(ErrorCode::config_bad_value,
                fmt::format("A scenario is for the virtual board only; the board is {}.", address));
  for (const Error& caution : config::find_cautions(config))
    log.add(Severity::warning, caution.to_string());
  auto channel = hal::cpu5::make_channel(
      address, config.connection.local_address, [&log](const Result<std::string>& way) {
        if (way) return log.add(Severity::info, "The way to the controller board: " + *way + ".");
        log.add(Severity::warning, way.error().to_string() + " The server goes on trying.");
      });
  if (!channel) return std::unexpected(channel.error());
  const std::string name = "CPU5 board at " + (*channel)->name();
  auto port = std::make_unique<hal::cpu5::WirePort>(std::move(*channel), hal::cpu5::WireSettings{});
  return Board{std::make_unique<hal::cpu5::Cpu5Driver>(config, hal::cpu5::driver_settings(config),
                                                       std::move(port)),
               name};
}

/// A board that is off, not found, busy or of another kind may be there later, or another in its
/// place: the link goes on trying, and the machine says what it waits for. A configuration that no
/// board can follow ends the start.
bool may_come_later(const Error& error) {
  return error.code != ErrorCode::axis_steps_per_unit_unusable &&
         error.code != ErrorCode::step_frequency_too_high;
}

int serve(const Options& options) {
  auto folder = DataFolder::open(options.data);
  if (!folder) return report(folder.error());
  auto data = folder->load(options.config, options.settings);
  if (!data) {
    report(data.error());
    return EXIT_FAILURE;
  }

  MessageLog log;
  auto board = make_board(options, data->config, log);
  if (!board) return report(board.error());
  hal::Controller& controller = *board->controller;

  const Epoch epoch = std::chrono::steady_clock::now();
  data->clock = [epoch] { return seconds_since(epoch); };
  hal::trace::Ring trace;
  TraceKeeper trace_keeper(trace, log, about_machine(data->config, board->name),
                           {.folder = std::filesystem::absolute(options.data) / kTraceFolder});
  Link link(std::make_unique<hal::trace::TracedController>(std::move(board->controller), trace));
  Machine machine(std::move(*data), link, log);
  if (machine.config().safety.shut_down_on_fatal)
    machine.set_loss_listener([] { ::kill(::getpid(), SIGTERM); });
  machine.set_fault_listener(
      [&](std::string_view reason) { trace_keeper.save_after_fault(reason); });
  TaskThread files;
  TaskThread fanout;
  TaskThread executor;
  const std::string executor_refused = executor.request_priority(kExecutorPriority);
  static_cast<void>(lock_memory());  // most of it, as long as nobody waits
  // Last of all: from now on the board misses a server that is silent.
  if (auto connected = controller.connect(); !connected && !may_come_later(connected.error()))
    return report(connected.error());
  LinkThread link_thread(link, epoch, kLinkPeriod);
  const std::string memory_refused = lock_memory();  // with the thread's stack
  const std::string& priority_refused =
      executor_refused.empty() ? link_thread.priority_refused() : executor_refused;

  rpc::Host host{machine,
                 executor,
                 link,
                 log,
                 fanout,
                 files,
                 options.jobs,
                 std::filesystem::absolute(options.data) / "dialogPictures",
                 board->name,
                 priority_refused.empty(),
                 std::chrono::duration<double>(kLinkPeriod).count(),
                 [&](TraceKeeper::Answer answer) { trace_keeper.save_now(std::move(answer)); },
                 board->press_estop};
  std::vector<std::string> addresses = options.listen;
  addresses.insert(addresses.begin(), "unix://" + options.socket);
  auto server = rpc::GrpcServer::start(host, addresses);
  if (!server) return report(server.error());
  protect_socket(options.socket);

  if (!priority_refused.empty() || !memory_refused.empty())
    spdlog::warn(
        "Running without real-time rights (priority: {}; memory: {}); docs/realtime.md "
        "says how to grant them.",
        priority_refused.empty() ? "granted" : priority_refused,
        memory_refused.empty() ? "locked" : memory_refused);
  executor.every(kMachinePeriod, [&] {
    machine.cycle(seconds_since(epoch));
    note_state(trace, machine);
    return true;
  });
  for (std::size_t i = 1; i < addresses.size(); ++i)
    spdlog::info("Listening on {} (port {}).", addresses[i], (*server)->ports()[i]);
  spdlog::info("cncserver {} is ready on unix://{}.", kServerVersion, options.socket);

  wait_for_signal();
  stop_machine(executor, machine);
  server->reset();
  executor.stop();
  std::error_code ignored;
  std::filesystem::remove(options.socket, ignored);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace cnc::server

int main(int argc, char** argv) {
  using namespace cnc::server;
  Options options;
  options.socket = default_socket();

  CLI::App app{
      "cncserver: owns the machine: G-code interpreter, motion planner and the link to the "
      "controller board.\nClients (cncctl, cncgui, pendants) reach it through its API."};
  app.add_option("--data", options.data, "Folder of the machine's configuration and state")
      ->capture_default_str();
  app.add_option("--config", options.config,
                 "Configuration file instead of cnc.ini in the data folder")
      ->check(CLI::ExistingFile);
  app.add_option("--set", options.settings,
                 "Overrides a setting: SECTION.key=value; may be repeated");
  app.add_option("--jobs", options.jobs, "Folder in which relative job paths begin")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  app.add_option("--board", options.board,
                 "Controller board instead of the configured one: virtual (built in), auto, "
                 "udp:HOST[:PORT] or serial:DEVICE[@RATE]; RATE in baud, of a line with wires "
                 "that does not run at 2000000 (auto asks at that rate only)");
  app.add_option("--scenario", options.scenario,
                 "How the virtual machine is built and what happens to it, docs/scenarios.md")
      ->check(CLI::ExistingFile);
  app.add_option("--socket", options.socket, "Unix socket for clients on this computer")
      ->capture_default_str();
  app.add_option("--listen", options.listen,
                 "TCP addresses, HOST:PORT; port 0 takes any free one. No authentication: keep to "
                 "loopback")
      ->capture_default_str();
  app.add_option("--log-level", options.log_level, "trace, debug, info, warn, error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error"}))
      ->capture_default_str();
  app.set_version_flag("--version", kServerVersion);
  CLI11_PARSE(app, argc, argv);

  spdlog::set_level(spdlog::level::from_str(options.log_level));
  spdlog::set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
  return serve(options);
}
