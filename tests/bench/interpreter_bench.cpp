// How fast programs are interpreted, beside the least that any reader of the same text must do:
// find the line ends and convert the numbers. Run it on a quiet machine; the ratios are what to
// compare.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fast_float/fast_float.h>
#include <fmt/format.h>
#include <random>
#include <string>
#include <string_view>

#include "interpreter/interpreter.h"

namespace {

using namespace cnc;
using namespace cnc::interp;

constexpr int kLines = 1'000'000;
constexpr int kArcs = 200'000;
constexpr int kRounds = 5;  // the best one counts: others were disturbed

/// A 3D surface as CAM systems write it: short moves, some words left out.
std::string straight_lines() {
  std::string text = "%\nG21 G90 G17 G40 G54\nG64 P0.02\nS12000 M3\nG0 X0 Y0 Z20\nF1800\n";
  double x = 0.0;
  double y = 0.0;
  double step = 0.1;
  for (int i = 0; i < kLines; ++i) {
    x += step;
    if (x > 100.0 || x < 0.0) {
      step = -step;
      x += step;
      y += 0.15;
    }
    const double z = -3 + 2 * std::sin(x * 0.13) * std::cos(y * 0.17) + 0.3 * std::sin(x * 1.7 + y);
    if (i % 50 == 0) {
      text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f} F{}\n", x - 50, y - 50, z,
                          1800 + i / 50 % 7 * 100);
    } else if (i % 3 == 0) {
      text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", x - 50, y - 50, z);
    } else if (i % 3 == 1) {
      text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", x - 50, y - 50, z);
    } else {
      text += fmt::format("X{:.3f} Z{:.3f}\n", x - 50, z);
    }
  }
  return text + "G0 Z20\nM30\n%\n";
}

std::string arcs() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> radius(1, 20);
  std::uniform_real_distribution<double> turn(0, 2 * M_PI);
  std::uniform_real_distribution<double> sweep(0.2, 3);
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  std::string text = "%\nG21 G90 G17 G40 G54\nG64 P0.02\nG0 X0 Y0 Z0\nF2000\n";
  double x = 0.0;
  double y = 0.0;
  for (int i = 0; i < kArcs; ++i) {
    const double r = radius(random);
    const double at = turn(random);
    const double by = i % 2 == 0 ? sweep(random) : -sweep(random);
    const double ci = rounded(-r * std::cos(at));
    const double cj = rounded(-r * std::sin(at));
    const double exact = std::hypot(ci, cj);
    const double begin = std::atan2(-cj, -ci);
    x = rounded(x + ci + exact * std::cos(begin + by));
    y = rounded(y + cj + exact * std::sin(begin + by));
    text += fmt::format("G{} X{:.4f} Y{:.4f} I{:.4f} J{:.4f}\n", by < 0 ? 2 : 3, x, y, ci, cj);
  }
  return text + "G0 Z20\nM30\n%\n";
}

std::string loop() {
  return fmt::format(
      "G21 G90 G17 G40 G54\nG64 P0.02\nG0 X0 Y0 Z0\nF2000\n#1=0\nwhile [#1 < {}]\n#2=[#1*0.36]\n"
      "#3=[50*cos[#2]+[3*sin[#2*7]]]\n#4=[50*sin[#2]+[3*cos[#2*7]]]\nG1 X#3 Y#4 Z[-#1/100000]\n"
      "#1=[#1+1]\nendwhile\nG0 Z20\nM30\n",
      kLines);
}

double seconds_of(const auto& work) {
  double best = HUGE_VAL;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    best = std::min(best, taken.count());
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

void measure(std::string_view name, std::string text, double rounds) {
  const auto program = Program::from_text(std::move(text), std::string(name));
  if (!program) std::exit(1);
  double sum = 0.0;
  std::string copy;
  for (std::uint32_t line = 1; line <= (*program)->line_count(); ++line) {
    copy.append((*program)->line(line)).append("\n");
  }
  const double index =
      seconds_of([&] { sum += (*Program::from_text(copy, "copy"))->line_count(); });
  const double scan = seconds_of([&] { sum += bare_scan(copy); });
  const double run = seconds_of([&] { sum += interpret(*program); });
  fmt::print("{:<16} {:>7.3f} s {:>7.2f} M/s", name, run, rounds / run / 1e6);
  // A loop has almost no text: there is nothing to compare it with.
  if ((*program)->line_count() > rounds / 2) {
    fmt::print("   bare scan {:.3f} s, ratio {:.2f}   index {:.3f} s", scan, run / scan, index);
  }
  fmt::print("   (sum {:.6g})\n", sum);
}

}  // namespace

int main() {
  fmt::print("per second: lines, arcs, rounds of a loop of seven lines with four sin or cos\n");
  measure("straight lines", straight_lines(), kLines);
  measure("arcs", arcs(), kArcs);
  measure("loop", loop(), kLines);
}
