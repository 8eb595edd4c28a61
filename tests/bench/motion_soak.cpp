// Random programs by the million: whether anything ever leaves the limits or the tube (--help).
#include <algorithm>
#include <cstdlib>
#include <fmt/core.h>
#include <string_view>

#include "tests/motion/program_judge.h"
#include "tests/motion/random_program.h"

namespace {

using namespace cnc::motion::test;

constexpr std::string_view kHelp =
    R"(motion_soak [segments=N] [seed=N] [jerk=N]

Drives random programs until so many moves are done, and judges the cubics that a controller would
execute: velocity, acceleration and jerk of every axis over their limits, the speed over the feed
and its override, and the largest distance between path and program over what P and Q allow,
globally and both ways; on exact paths over 0.2 µm. Prints the worst of each, and the first program that fails, made as small as possible; then it returns 1.

  segments=100000   moves in all
  seed=1            of the first program; each next one has the next
  jerk=0            every so manieth program has limits of jerk; 0: none
)";

constexpr int kMovesOfProgram = 400;

void include(Verdict& worst, const Verdict& verdict) {
  worst.velocity = std::max(worst.velocity, verdict.velocity);
  worst.acceleration = std::max(worst.acceleration, verdict.acceleration);
  worst.jerk = std::max(worst.jerk, verdict.jerk);
  worst.feed = std::max(worst.feed, verdict.feed);
  worst.path_to_program = std::max(worst.path_to_program, verdict.path_to_program);
  worst.program_to_path = std::max(worst.program_to_path, verdict.program_to_path);
  worst.time += verdict.time;
  worst.setpoints += verdict.setpoints;
  worst.refused += verdict.refused;
}

int soak(long segments, std::uint32_t seed, std::uint32_t jerk) {
  Verdict worst;
  long done = 0;
  for (; done < segments; done += kMovesOfProgram, ++seed) {
    Dice dice(seed);
    const RandomProgram program =
        random_program(dice, kMovesOfProgram, {.jerk = jerk > 0 && seed % jerk == 0});
    const Verdict verdict = judge(program);
    include(worst, verdict);
    if (!verdict.is_sound()) {
      fmt::print("seed {} fails: {}\n", seed, verdict.to_string());
      std::fflush(stdout);
      fmt::print("{}\n", smallest_failure(program));
      return EXIT_FAILURE;
    }
    if (done / 1'000'000 != (done + kMovesOfProgram) / 1'000'000) {
      fmt::print("{} moves, seed {}: {}\n", done + kMovesOfProgram, seed, worst.to_string());
      std::fflush(stdout);
    }
  }
  fmt::print("{} moves, {} setpoints, {:.0f} h of motion, {} moves refused: {}\n", done,
             worst.setpoints, worst.time / 3600.0, worst.refused, worst.to_string());
  return EXIT_SUCCESS;
}

}  // namespace

int main(int count, char** values) {
  long segments = 100'000;
  std::uint32_t seed = 1;
  std::uint32_t jerk = 0;
  for (int i = 1; i < count; ++i) {
    const std::string_view argument = values[i];
    if (argument.starts_with("segments=")) {
      segments = std::atol(values[i] + 9);
    } else if (argument.starts_with("seed=")) {
      seed = static_cast<std::uint32_t>(std::atol(values[i] + 5));
    } else if (argument.starts_with("jerk=")) {
      jerk = static_cast<std::uint32_t>(std::atol(values[i] + 5));
    } else {
      fmt::print("{}", kHelp);
      return argument == "--help" ? EXIT_SUCCESS : EXIT_FAILURE;
    }
  }
  return soak(segments, seed, jerk);
}
