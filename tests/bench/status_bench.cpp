// What status subscribers cost the link thread: its lateness and its work in ten seconds of a
// running job without and with twenty subscribers at 50 Hz, each with a connection of its own.
//
//   status_bench build/release/bin/cncserver [SECONDS]
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "api/client.h"
#include "tests/config/temporary_directory.h"
#include "tests/process.h"

namespace {

using namespace cnc;
using namespace cnc::api;

constexpr int kSubscribers = 20;
constexpr double kRate = 50.0;

template <typename T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().to_string());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

Client connect_when_ready(const std::string& address) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  for (;;) {
    if (auto client = Client::connect(address)) return std::move(*client);
    if (std::chrono::steady_clock::now() > end)
      throw std::runtime_error("the server does not answer");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

/// A square without end, at a speed that keeps planner and link busy with short segments.
constexpr const char* kJob =
    "G53 G0 X10 Y10\nG91 F3000\nwhile [1 == 1]\nG1 X20\nG3 X10 Y10 J10\nG1 Y20\nG1 X-30\nG1 Y-30\n"
    "endwhile\n";

void start_job(const Client& client, const cnc::config::test::TemporaryDirectory& folder) {
  const auto job = folder.file("job.nc");
  cnc::config::test::put(job, kJob);
  must(client.reset());
  must(client.home());
  must(client.load(job.string()));
  must(client.run());
}

LinkStatistics measure(const Client& client, std::chrono::seconds time) {
  must(client.link_statistics(true));
  std::this_thread::sleep_for(time);
  return must(client.link_statistics());
}

/// The upper edge of the bin in which `part` of all cycles is reached, s.
double quantile(const std::vector<HistogramBin>& bins, double part) {
  std::uint64_t total = 0;
  for (const HistogramBin& bin : bins) total += bin.count;
  std::uint64_t sum = 0;
  for (const HistogramBin& bin : bins) {
    sum += bin.count;
    if (static_cast<double>(sum) >= part * static_cast<double>(total)) return bin.upper;
  }
  return INFINITY;
}

void print_side_by_side(const char* what, const std::vector<HistogramBin>& alone,
                        const std::vector<HistogramBin>& watched) {
  fmt::print("\n{:>12}   {:>10} {:>10}\n", what, "alone", "watched");
  for (std::size_t i = 0; i < alone.size(); ++i)
    if (alone[i].count + watched[i].count > 0)
      fmt::print("{:>9.0f} us   {:>10} {:>10}\n", alone[i].upper * 1e6, alone[i].count,
                 watched[i].count);
  for (const double part : {0.5, 0.99}) {
    const double a = quantile(alone, part);
    const double w = quantile(watched, part);
    fmt::print("{:>9.0f} %    {:>7.0f} us {:>7.0f} us   ratio {:.2f}\n", part * 100.0, a * 1e6,
               w * 1e6, w / a);
  }
}

void print_worst(const char* what, double alone, double watched) {
  fmt::print("{:<18} {:>9.3f} ms {:>9.3f} ms   ratio {:.2f}\n", what, alone * 1e3, watched * 1e3,
             watched / alone);
}

int run(const std::string& server_program, std::chrono::seconds time) {
  const cnc::config::test::TemporaryDirectory folder;
  const std::string socket = folder.file("socket").string();
  const test::Process server(
      {server_program, "--data", folder.file("data").string(), "--socket", socket, "--listen",
       "127.0.0.1:0", "--set", "AXIS_X.positiveLimit=80", "--set", "AXIS_Y.positiveLimit=80"},
      folder.file("log").string());
  const std::string address = "unix://" + socket;
  const Client client = connect_when_ready(address);
  start_job(client, folder);

  const LinkStatistics alone = measure(client, time);
  std::atomic<std::uint64_t> received{0};
  std::vector<Client> clients;
  std::vector<Subscription> subscriptions;
  for (int i = 0; i < kSubscribers; ++i) {
    clients.push_back(connect_when_ready(address));
    subscriptions.push_back(clients.back().subscribe_status(
        {.max_rate = kRate}, [&](const MachineStatus&) { ++received; }));
  }
  const std::uint64_t before = received;
  const LinkStatistics watched = measure(client, time);
  const double rate =
      static_cast<double>(received - before) / (static_cast<double>(time.count()) * kSubscribers);

  fmt::print("{} s each; link period {:.1f} ms; real-time rights: {}\n", time.count(),
             alone.cycle_time * 1e3, alone.real_time ? "yes" : "no");
  fmt::print("{} subscribers received {:.1f} statuses per second each\n", kSubscribers, rate);
  print_side_by_side("lateness <", alone.lateness, watched.lateness);
  print_side_by_side("work <", alone.work, watched.work);
  fmt::print("\n");
  print_worst("worst lateness", alone.max_lateness, watched.max_lateness);
  print_worst("longest work", alone.max_work, watched.max_work);
  print_worst("lowest FIFO time", alone.lowest_fifo_time, watched.lowest_fifo_time);
  const auto state = must(client.status()).state;
  fmt::print("state at the end   {}\n", name_of(state));
  return state == MachineState::running ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) {
    fmt::print(stderr, "status_bench CNCSERVER [SECONDS]\n");
    return 2;
  }
  try {
    return run(arguments[1], std::chrono::seconds(count > 2 ? std::atoi(arguments[2]) : 10));
  } catch (const std::exception& error) {
    fmt::print(stderr, "status_bench: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
