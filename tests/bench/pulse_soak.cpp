// A day of step pulses: 100 kHz to and fro for so many hours of the board's time, every pulse
// looked at (tests/hal/pulse_strokes.h).
//
//   pulse_soak [HOURS]    default 24: 8.6e9 pulses
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "tests/hal/pulse_strokes.h"

int main(int argc, char** argv) {
  using namespace cnc::hal::cpu5::firmware;
  const double hours = argc > 1 ? std::atof(argv[1]) : 24.0;
  const auto begin = std::chrono::steady_clock::now();
  PulseStrokes strokes;
  const auto seconds = [&] { return static_cast<double>(strokes.time()) / kTicksPerSecond; };
  bool good = true;
  while (good && seconds() < hours * 3600) good = strokes.stroke(600);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  std::printf("%.3f h of the board's time, %llu pulses in %.1f s, %.1f ns each: %s\n",
              seconds() / 3600, static_cast<unsigned long long>(strokes.pulses()), spent.count(),
              spent.count() * 1e9 / static_cast<double>(strokes.pulses()),
              good ? "none lost, none doubled, none out of its time" : "NOT GOOD");
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
