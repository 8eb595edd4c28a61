#include "interpreter_programs.h"

#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <random>

namespace cnc::bench {

std::string straight_lines(int lines) {
  std::string text = "%\nG21 G90 G17 G40 G54\nG64 P0.02\nS12000 M3\nG0 X0 Y0 Z20\nF1800\n";
  double x = 0.0;
  double y = 0.0;
  double step = 0.1;
  for (int i = 0; i < lines; ++i) {
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

std::string arcs(int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> radius(1, 20);
  std::uniform_real_distribution<double> turn(0, 2 * std::numbers::pi);
  std::uniform_real_distribution<double> sweep(0.2, 3);
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  std::string text = "%\nG21 G90 G17 G40 G54\nG64 P0.02\nG0 X0 Y0 Z0\nF2000\n";
  double x = 0.0;
  double y = 0.0;
  for (int i = 0; i < count; ++i) {
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

namespace {

/// `head` and `tail` are the two lines that the dialects write differently.
std::string loop_with(std::string_view head, std::string_view tail) {
  return fmt::format(
      "%\nG21 G90 G17 G40 G54\nG64 P0.02\nG0 X0 Y0 Z0\nF2000\n#1=0\n{}\n#2=[#1*0.36]\n"
      "#3=[50*cos[#2]+[3*sin[#2*7]]]\n#4=[50*sin[#2]+[3*cos[#2*7]]]\nG1 X#3 Y#4 Z[-#1/100000]\n"
      "#1=[#1+1]\n{}\nG0 Z20\nM30\n%\n",
      head, tail);
}

}  // namespace

std::string loop(int rounds) {
  return loop_with(fmt::format("while [#1 < {}]", rounds), "endwhile");
}

std::string loop_for_linuxcnc(int rounds) {
  return loop_with(fmt::format("O100 while [#1 LT {}]", rounds), "O100 endwhile");
}

std::string sub_calls(int calls) {
  return fmt::format(
      "sub step\n#2=[#2+0.001]\nendsub\n#1=0\nwhile [#1 < {}]\ngosub step\n#1=[#1+1]\nendwhile\n"
      "M30\n",
      calls);
}

std::string holes(int count) {
  constexpr int kRow = 100;
  std::string text = "G21 G90 G17 G54\nG0 X0 Y0 Z20\nF300\nG81 X0 Y0 Z-4 R2\n";
  for (int i = 1; i < count; ++i) text += fmt::format("X{} Y{}\n", i % kRow * 5, i / kRow * 5);
  return text + "G80\nM30\n";
}

std::string compensated_moves(int count) {
  std::string text = "G21 G90 G17 G54\nG0 X0 Y0 Z0\nF1000\nG41.1 D2\nG1 X10\n";
  for (int i = 1; i <= count; ++i) {
    const int height = (i + 1) / 2 * 5;
    text += i % 2 == 1 ? fmt::format("Y{}.25\n", height) : fmt::format("X{}.5\n", 10 + height);
  }
  return text + "G40\nM30\n";
}

}  // namespace cnc::bench
