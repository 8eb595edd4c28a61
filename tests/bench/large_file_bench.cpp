// A program of 100 million lines: how long until it is ready, what memory it takes, how fast any
// line is found, and that loops and subs at both ends of it work.
//
//   large_file_bench FOLDER [MILLIONS]    writes a file of 30 bytes a line into FOLDER, deletes it
//
// The file has just been written, so it comes from the page cache as far as memory allows. Times of
// the processor do not count what else runs on the machine.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "interpreter/interpreter.h"

namespace {

using namespace cnc;
using namespace cnc::interp;
constexpr int kPiece = 100'000;  ///< lines that are written at once, again and again

// X counts the calls of `first`, 3 in either loop; Y those of `last`, 3 in the second one.
constexpr std::string_view kHead =
    "G21 G90 G17 G40 G54\nF1800\nsub first\n#2=[#2+1]\nG1 X#2\nendsub\n#1=0\nwhile [#1 < 3]\n"
    "gosub first\n#1=[#1+1]\nendwhile\n";
constexpr std::string_view kTail =
    "#1=0\nwhile [#1 < 3]\ngosub first\ngosub last\n#1=[#1+1]\nendwhile\nM30\nsub last\n"
    "#3=[#3+1]\nG1 Y#3\nendsub\n";

class Stopwatch {
 public:
  /// Seconds on the wall; of this process on the processor.
  [[nodiscard]] double wall() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
  }
  [[nodiscard]] double processor() const { return processor_now() - processor_; }

 private:
  [[nodiscard]] static double processor_now() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
  }

  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double processor_ = processor_now();
};

/// A line of /proc/self/status, MB.
double memory(std::string_view name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name)) return std::atof(line.c_str() + name.size()) / 1024.0;
  }
  return 0.0;
}

void write_program(const std::filesystem::path& path, int lines) {
  std::string piece;
  for (int i = 0; i < kPiece; ++i) {
    fmt::format_to(std::back_inserter(piece), "G1 X{:.3f} Y{:.3f} Z-{:.3f}\n",
                   100.0 + i % 991 * 0.1, 100.0 + i % 877 * 0.1, 1.0 + i % 7 * 0.1);
  }
  std::ofstream file(path, std::ios::binary);
  file << kHead;
  for (int written = 0; written < lines; written += kPiece) file << piece;
  file << kTail;
}

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

/// The file is deleted whatever happens.
class Removed {
 public:
  explicit Removed(std::filesystem::path path) : path_(std::move(path)) {}
  ~Removed() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  Removed(const Removed&) = delete;
  Removed& operator=(const Removed&) = delete;

 private:
  std::filesystem::path path_;
};

/// Where the program's moves end, and how many there were.
struct Run {
  std::uint64_t moves = 0;
  Position end;
};
Run interpret(const std::shared_ptr<const Program>& program, std::uint32_t from,
              std::uint64_t max_moves) {
  config::ParameterStore parameters;
  config::ToolTable tools;
  Interpreter interpreter({}, parameters, tools);
  // What the head says.
  interpreter.start(Program::from_text("G90 F1800\n", "modes").value(), {});
  while (interpreter.next() != Progress::ended) {
  }
  interpreter.start(program, {}, {.line = from});
  Run run;
  while (run.moves < max_moves) {
    const Progress progress = interpreter.next();
    if (progress == Progress::failed) fail(interpreter.diagnostic().to_string());
    if (progress == Progress::ended) break;
    if (progress != Progress::command) continue;
    if (const auto* move = std::get_if<FeedMove>(&interpreter.command().body)) {
      ++run.moves;
      run.end = move->end;
    }
  }
  return run;
}

/// Mean and longest time of the processor to find a line.
void measure_jumps(const Program& program) {
  constexpr int kJumps = 100'000;
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint32_t> any(1, program.line_count());
  double longest = 0.0;
  double sum = 0.0;
  for (int i = 0; i < kJumps; ++i) {
    const std::uint32_t number = any(random);
    const Stopwatch watch;
    if (program.line(number).empty()) fail("an empty line");
    const double taken = watch.processor() * 1e3;
    longest = std::max(longest, taken);
    sum += taken;
  }
  fmt::print("jump to any line     {:.4f} ms, longest of {} {:.3f} ms   (goal 10 ms)\n",
             sum / kJumps, kJumps, longest);
}

void measure(const std::filesystem::path& path) {
  const double before = memory("RssAnon:");
  const Stopwatch opening;
  const auto opened = Program::open(path);
  if (!opened) fail(opened.error().to_string());
  const double ready = opening.wall();
  const double ready_processor = opening.processor();
  const Program& program = **opened;
  fmt::print("{} lines, {:.2f} GB\n", program.line_count(),
             static_cast<double>(program.size()) / 1e9);
  fmt::print("open and index       {:.2f} s, {:.2f} s of the processor   (goal 10 s)\n", ready,
             ready_processor);
  fmt::print("memory, not mapped   {:.1f} MB, {:.1f} before   (goal 100 MB)\n", memory("RssAnon:"),
             before);
  measure_jumps(program);

  const Run head = interpret(*opened, 1, 3);
  if (head.end[Axis::X] != 3.0) fail("the loop at the beginning");
  const auto tail_lines = static_cast<std::uint32_t>(std::ranges::count(kTail, '\n'));
  const Run tail = interpret(*opened, program.line_count() - tail_lines + 1, 1000);
  if (tail.moves != 6 || tail.end[Axis::Y] != 3.0) fail("the loop at the end");
  const Stopwatch running;
  const Run whole = interpret(*opened, 1, ~std::uint64_t{0});
  const double taken = running.processor();
  if (whole.end[Axis::X] != 6.0 || whole.end[Axis::Y] != 3.0) fail("the whole program");
  fmt::print("interpreted whole    {:.2f} s of the processor, {:.2f} M moves/s\n", taken,
             static_cast<double>(whole.moves) / taken / 1e6);
  fmt::print("memory, not mapped   {:.1f} MB, highest of everything {:.0f} MB\n",
             memory("RssAnon:"), memory("VmHWM:"));
}

}  // namespace

int main(int count, char** values) {
  const std::span arguments(values + 1, static_cast<std::size_t>(count - 1));
  if (arguments.empty() || arguments.size() > 2) {
    fmt::print("usage: large_file_bench FOLDER [MILLIONS]\n");
    return 2;
  }
  const int millions = arguments.size() == 2 ? std::atoi(arguments[1]) : 100;
  const std::filesystem::path path = std::filesystem::path(arguments[0]) / "large_file_bench.ngc";
  const Removed removed(path);
  try {
    write_program(path, millions * 1'000'000);
    measure(path);
  } catch (const std::exception& failure) {
    fmt::print("FAILED: {}\n", failure.what());
    return 1;
  }
}
