// The link under load: cncserver and a virtual board by UDP, a job without end, clients that follow
// its status, and stress-ng on every core. How low the FIFO falls, and how soon a feed hold acts.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "api/client.h"
#include "tests/bench/bench_options.h"
#include "tests/bench/link_tap.h"
#include "tests/bench/stall_watch.h"
#include "tests/config/temporary_directory.h"
#include "tests/process.h"

namespace {

using namespace cnc;
using namespace cnc::api;
using Clock = bench::LinkTap::Clock;
using Seconds = std::chrono::duration<double>;

constexpr const char* kHelp =
    R"(link_bench [minutes=1] [clients=20] [stress=1] [holds=100] [loss=0] [jitter=0] BIN

  BIN       folder with cncserver and cpu5sim
  minutes   of the job for the FIFO's level
  clients   that follow the status, 50 times a second each
  stress    1: stress-ng keeps every core busy, with numbers and with memory
  holds     feed holds at random instants, 0.2 s and more apart
  loss      part of the packets that the cable loses, 0 … 1
  jitter    seconds that a packet may be late
)";

template <typename T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().to_string());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// A square without end, at a speed that keeps planner and link busy with short segments.
constexpr const char* kJob =
    "G53 G0 X10 Y10\nG91 G64 P0.01 F3000\nwhile [1 == 1]\nG1 X20\nG3 X10 Y10 J10\nG1 Y20\n"
    "G1 X-30\nG1 Y-30\nendwhile\n";

const std::vector<std::string> kMachine{
    "AXIS_X.positiveLimit=80", "AXIS_Y.positiveLimit=80", "AXIS_X.homeVelocity=0",
    "AXIS_Y.homeVelocity=0",   "AXIS_Z.homeVelocity=0",
};

/// A program with the settings of kMachine behind it, and its words before and behind.
std::vector<std::string> command(std::vector<std::string> words,
                                 const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  for (const std::string& setting : kMachine) {
    words.emplace_back("--set");
    words.push_back(setting);
  }
  return words;
}

/// The board's UDP port, as cpu5sim says it.
unsigned short port_of(const test::Process& board) {
  for (int i = 0; i < 100; ++i) {
    const std::string said = board.out();
    if (const auto newline = said.find('\n'); newline != std::string::npos) {
      const auto colon = said.rfind(':', newline);
      return static_cast<unsigned short>(std::stoi(said.substr(colon + 1)));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  throw std::runtime_error("cpu5sim does not say its port: " + board.err());
}

/// The machine with all its processes, running the job.
class Bench {
 public:
  Bench(const std::string& programs, const bench::Options& options)
      // The board is hardware: what keeps this computer busy does not delay it.
      : board_(command({"/usr/bin/chrt", "-f", "70", programs + "/cpu5sim"},
                       {"--port", "0", "--loss", fmt::to_string(options["loss"]), "--jitter",
                        fmt::to_string(options["jitter"])}),
               folder_.file("board").string()),
        tap_(port_of(board_)),
        server_(command({programs + "/cncserver"},
                        {"--data", folder_.file("data").string(), "--socket", socket(), "--listen",
                         "127.0.0.1:0", "--board", fmt::format("udp:127.0.0.1:{}", tap_.port())}),
                folder_.file("server").string()),
        client_(connected()) {
    const auto job = folder_.file("job.nc");
    config::test::put(job, kJob);
    must(client_.reset());
    must(client_.home());
    must(client_.load(job.string()));
    must(client_.run());
  }

  const Client& client() const { return client_; }
  const bench::LinkTap& tap() const { return tap_; }
  std::filesystem::path data() const { return folder_.file("data"); }

  void add_followers(int count) {
    for (int i = 0; i < count; ++i) {
      followers_.push_back(connected());
      subscriptions_.push_back(followers_.back().subscribe_status(
          {.max_rate = 50.0}, [this](const MachineStatus&) { ++statuses_; }));
    }
  }
  [[nodiscard]] std::uint64_t statuses() const { return statuses_; }

 private:
  [[nodiscard]] std::string socket() const { return folder_.file("socket").string(); }
  [[nodiscard]] Client connected() const {
    const auto end = Clock::now() + std::chrono::seconds(30);
    for (;;) {
      if (auto client = Client::connect("unix://" + socket())) return std::move(*client);
      if (Clock::now() > end) throw std::runtime_error("no answer: " + server_.err());
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  config::test::TemporaryDirectory folder_;
  test::Process board_;
  bench::LinkTap tap_;
  test::Process server_;
  Client client_;
  std::atomic<std::uint64_t> statuses_{0};
  std::vector<Client> followers_;
  std::vector<Subscription> subscriptions_;
};

void print_percentiles(const char* what, std::vector<double> seconds) {
  if (seconds.empty()) return fmt::print("| {} | 0 | | | |\n", what);
  std::ranges::sort(seconds);
  const auto at = [&](double part) {
    return 1e3 * seconds[static_cast<std::size_t>(part * static_cast<double>(seconds.size() - 1))];
  };
  fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", what, seconds.size(), at(0.5), at(0.99),
             at(1.0));
}

/// From the client's call to the answer of the board that shows it on the braking ramp.
void measure_holds(const Bench& machine, int count, const char* when) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> pause(0.2, 0.7);
  std::vector<double> begins;
  std::vector<double> stands;
  for (int i = 0; i < count; ++i) {
    std::this_thread::sleep_for(Seconds(pause(random)));
    const std::uint64_t cuts = machine.tap().cuts();
    const auto asked = Clock::now();
    must(machine.client().pause());
    const auto stood = Clock::now();
    if (machine.tap().cuts() != cuts)
      begins.push_back(Seconds(machine.tap().last_cut() - asked).count());
    stands.push_back(Seconds(stood - asked).count());
    must(machine.client().resume());
  }
  print_percentiles(fmt::format("{}: call to ramp", when).c_str(), begins);
  print_percentiles(fmt::format("{}: call to answer, standing", when).c_str(), stands);
}

/// Whether the job ran to the end of the measurement.
bool measure(Bench& machine, const bench::Options& options) {
  const bool loaded = options["stress"] > 0.0;
  fmt::print("{} cores; real-time rights: {}; {} clients; stress-ng: {}; loss {} %, jitter {} ms\n",
             std::thread::hardware_concurrency(),
             must(machine.client().link_statistics()).real_time ? "yes" : "no", options["clients"],
             loaded ? "every core" : "no", 100.0 * options["loss"], 1e3 * options["jitter"]);
  fmt::print("\n| feed hold, ms | holds | median | 99 % | longest |\n|---|---:|---:|---:|---:|\n");
  const int holds = static_cast<int>(options["holds"]);
  if (holds > 0) measure_holds(machine, holds, "quiet");

  machine.add_followers(static_cast<int>(options["clients"]));
  std::unique_ptr<test::Process> stress;
  if (loaded)
    stress = std::make_unique<test::Process>(
        std::vector<std::string>{"/usr/bin/stress-ng", "--cpu", "0", "--vm", "1", "--vm-bytes",
                                 "128M"},
        (std::filesystem::temp_directory_path() / "link_bench_stress").string());
  std::this_thread::sleep_for(std::chrono::seconds(2));
  if (holds > 0) measure_holds(machine, holds, "under load");
  std::fflush(stdout);

  bench::StallWatch cores;
  must(machine.client().link_statistics(true));
  const std::uint64_t statuses = machine.statuses();
  const std::uint64_t packets = machine.tap().packets();
  const auto begin = Clock::now();
  const auto end = begin + std::chrono::duration<double, std::ratio<60>>(options["minutes"]);
  MachineState state = MachineState::running;
  while (Clock::now() < end && state == MachineState::running) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    state = must(machine.client().status()).state;
  }
  const double time = Seconds(Clock::now() - begin).count();
  const LinkStatistics link = must(machine.client().link_statistics());
  const auto per_second = [time](std::uint64_t count) { return static_cast<double>(count) / time; };
  fmt::print("\n{:.0f} s of the job; state at the end: {}\n", time, name_of(state));
  fmt::print("lowest FIFO       {:.3f} s\n", link.lowest_fifo_time);
  fmt::print(
      "cycles            {} of {:.1f} ms; worst lateness {:.2f} ms, longest work {:.2f} ms\n",
      link.cycles, 1e3 * link.cycle_time, 1e3 * link.max_lateness, 1e3 * link.max_work);
  fmt::print("a core was away   {:.2f} ms at the longest\n", 1e3 * cores.longest());
  fmt::print("packets           {:.0f} per second, both ways\n",
             per_second(machine.tap().packets() - packets));
  fmt::print("statuses          {:.0f} per second, all clients\n",
             per_second(machine.statuses() - statuses));
  return state == MachineState::running;
}

void print_messages(const Client& client) {
  for (const Message& message : must(client.messages()))
    fmt::print("{:%T} {}\n", message.time, message.text);
}

/// In the current folder: the machine's own is gone with the bench.
void keep_traces(const std::filesystem::path& folder) {
  std::error_code none_was_written;
  for (const auto& trace : std::filesystem::directory_iterator(folder, none_was_written)) {
    std::filesystem::copy(trace, std::filesystem::current_path());
    fmt::print("kept: {}\n", trace.path().filename().string());
  }
}

int run(const std::string& programs, const bench::Options& options) {
  Bench machine(programs, options);
  try {
    if (measure(machine, options)) return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print("link_bench: {}\n", error.what());
  }
  std::this_thread::sleep_for(std::chrono::seconds(3));  // the trace has what follows, too
  print_messages(machine.client());
  keep_traces(machine.data() / "traces");
  return EXIT_FAILURE;
}

}  // namespace

int main(int count, char** arguments) {
  const bench::Options options({{"minutes", 1.0},
                                {"clients", 20.0},
                                {"stress", 1.0},
                                {"holds", 100.0},
                                {"loss", 0.0},
                                {"jitter", 0.0}},
                               count, arguments);
  if (options.files().size() != 1 || options.files().front().starts_with('-')) {
    fmt::print("{}", kHelp);
    return 2;
  }
  try {
    return run(options.files().front(), options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "link_bench: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
