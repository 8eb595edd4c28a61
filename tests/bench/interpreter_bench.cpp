// How fast programs are interpreted, beside the least that any reader of the same text must do:
// find the line ends and convert the numbers.
//
//   interpreter_bench [NAME ...]      all rows of the table, or those named
//   interpreter_bench write DIR       the programs that peer_interpreter.sh gives to both sides
//
// Times are of the processor, not of the clock on the wall, so that another load on the machine
// disturbs less; the best of some runs counts. The ratios are what to compare.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fast_float/fast_float.h>
#include <fmt/format.h>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include "interpreter_programs.h"

#include "interpreter/interpreter.h"
#include "interpreter/line.h"
#include "interpreter/machine_state.h"

namespace {

using namespace cnc;
using namespace cnc::interp;

constexpr int kRepetitions = 7;

struct Row {
  std::string_view name;
  std::string (*program)(int);
  int count;
  std::string_view unit;
  bool is_text;  ///< as many lines as things to count: comparable with the bare scan
};
constexpr auto kRows = std::to_array<Row>({
    {"lines", bench::straight_lines, 1'000'000, "lines", true},
    {"arcs", bench::arcs, 200'000, "arcs", true},
    {"loop", bench::loop, 1'000'000, "rounds", false},
    {"subs", bench::sub_calls, 1'000'000, "calls", false},
    {"holes", bench::holes, 200'000, "holes", true},
    {"compensated", bench::compensated_moves, 200'000, "moves", true},
});

double seconds_of(const auto& work) {
  double best = HUGE_VAL;
  for (int i = 0; i < kRepetitions; ++i) {
    const std::clock_t begin = std::clock();
    work();
    best = std::min(best, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return best;
}

/// Sum of all numbers of the text, so that the compiler cannot leave anything out.
double bare_scan(std::string_view text) {
  double sum = 0.0;
  const char* line = text.data();
  const char* const end = text.data() + text.size();
  while (line < end) {
    const void* found = std::memchr(line, '\n', static_cast<std::size_t>(end - line));
    const char* line_end = found == nullptr ? end : static_cast<const char*>(found);
    for (const char* p = line; p < line_end; ++p) {
      double value = 0.0;
      const auto number = fast_float::from_chars(p, line_end, value);
      if (number.ec != std::errc()) continue;
      sum += value;
      p = number.ptr - 1;
    }
    line = line_end + 1;
  }
  return sum;
}

double interpret(const std::shared_ptr<const Program>& program) {
  config::ParameterStore parameters;
  config::ToolTable tools;
  Interpreter interpreter({}, parameters, tools);
  interpreter.start(program, {});
  double sum = 0.0;
  for (;;) {
    switch (interpreter.next()) {
      case Progress::command:
        if (const auto* move = std::get_if<FeedMove>(&interpreter.command().body)) {
          sum += move->end[Axis::X];
        }
        break;
      case Progress::working:
      case Progress::waiting:
      case Progress::found:
        break;
      case Progress::failed:
        fmt::print("{}", interpreter.diagnostic().to_string());
        std::exit(1);
      case Progress::ended:
        return sum;
    }
  }
}

void measure(const Row& row) {
  const std::string text = row.program(row.count);
  const auto program = Program::from_text(text, std::string(row.name));
  if (!program) std::exit(1);
  double sum = 0.0;
  const double run = seconds_of([&] { sum += interpret(*program); });
  fmt::print("{:<12} {:>7.3f} s {:>6.2f} M {}/s", row.name, run, row.count / run / 1e6, row.unit);
  if (row.is_text) {
    const double index = seconds_of([&] { sum += (*Program::from_text(text, ""))->line_count(); });
    const double scan = seconds_of([&] { sum += bare_scan(text); });
    fmt::print("   bare scan {:.1f} M/s, ratio {:.2f}   index {:.3f} s", row.count / scan / 1e6,
               run / scan, index);
  }
  fmt::print("   (sum {:.6g})\n", sum);
}

int write_programs(const std::string& folder) {
  const auto write = [&](std::string_view name, const std::string& text) {
    std::ofstream(fmt::format("{}/{}", folder, name), std::ios::binary) << text;
  };
  write("lines.ngc", bench::straight_lines(1'000'000));
  write("arcs.ngc", bench::arcs(200'000));
  write("loop.ngc", bench::loop(1'000'000));
  write("loop_for_linuxcnc.ngc", bench::loop_for_linuxcnc(1'000'000));
  return 0;
}

}  // namespace

int main(int count, char** values) {
  const std::span arguments(values + 1, static_cast<std::size_t>(count - 1));
  if (arguments.size() == 2 && std::string_view(arguments[0]) == "write") {
    return write_programs(arguments[1]);
  }
  fmt::print("bytes: Command {}, Block {}, Line {}, MachineState {}\n", sizeof(Command),
             sizeof(Block), sizeof(Line), sizeof(MachineState));
  for (const Row& row : kRows) {
    const bool wanted = arguments.empty() || std::ranges::any_of(arguments, [&](const char* name) {
                          return row.name == name;
                        });
    if (wanted) measure(row);
  }
}
