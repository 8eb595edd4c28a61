// How fast the planner is, and how close its job times are to what the limits allow (--help).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fmt/core.h>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "motion/planner.h"
#include "tests/bench/path_program.h"
#include "tests/motion/time_bound.h"

namespace {

using namespace cnc;
using namespace cnc::motion;

constexpr std::string_view kHelp =
    R"(motion_bench [p=MM] [grid=S] [FILE ...]

Without files: rates of planning, and job times of a square and circles beside the least time that
the limits allow (100 mm/s and 500 mm/s² on each of X Y Z, feed 100 mm/s).

With files: a table of job times divided by the least time for the very path that was driven. All
feed moves get one feed. Files that turn rotary axes, or of which more than one line in a hundred is
refused, are passed over.

  p=0.02        path tolerance (G64 P), mm; 0: exact path (G61)
  grid=0.0005   steps of the bound, seconds of the driven motion
)";

/// Of each of X Y Z, and the feed of all moves; mm and s.
struct Limits {
  double velocity;
  double acceleration;
  double feed;
};
constexpr Limits kLimits[] = {
    {100, 500, 100}, {200, 2000, 200}, {500, 5000, 500}, {50, 200, 50}, {100, 2000, 25}};

constexpr double kPi = std::numbers::pi;

Position xyz(double x, double y, double z = 0.0) {
  Position p;
  p[Axis::X] = x;
  p[Axis::Y] = y;
  p[Axis::Z] = z;
  return p;
}

PlannerSettings settings() {
  return {{Position::filled(100.0), Position::filled(500.0)}, 0.005, 1.0};
}

MoveOptions feed() {
  MoveOptions options;
  options.feed = 100.0;
  return options;
}

/// What a program did with the planner.
struct Run {
  Planner planner{settings(), {}};
  double job_time = 0.0;
  long setpoints = 0;

  void draw() {
    const auto setpoint = planner.next();
    if (!setpoint) return;
    job_time += setpoint->duration;
    ++setpoints;
  }
  void accept(const Result<void>& result) {
    if (!result) {
      fmt::print("refused: {}\n", result.error().to_string());
      std::exit(1);
    }
    while (planner.full()) draw();
  }
  void line(const Position& end) { accept(planner.add_line(end, feed())); }
  void arc(const ArcShape& shape) { accept(planner.add_arc(shape, feed())); }
  void finish() {
    while (!planner.idle()) draw();
  }
};

/// A wavy line of `count` chords of 0.5 mm; neighbours differ by less than the LAF angle.
void chords(Run& run, int count) {
  double x = 0.0;
  double y = 0.0;
  for (int i = 0; i < count; ++i) {
    const double heading = 0.8 * std::sin(0.01 * i);
    x += 0.5 * std::cos(heading);
    y += 0.5 * std::sin(heading);
    run.line(xyz(x, y));
  }
}

/// Half circles of 5 mm radius, up and down, that touch each other.
void waves(Run& run, int count) {
  for (int i = 0; i < count; ++i) {
    const double x = 10.0 * i;
    run.arc({xyz(x + 10.0, 0), Plane::xy, x + 5.0, 0.0, i % 2 == 0 ? 1 : -1});
  }
}

template <typename Program>
void measure_rate(const char* name, int count, Program program) {
  const auto begin = std::chrono::steady_clock::now();
  Run run;
  program(run, count);
  run.finish();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  fmt::print("{:<28} {:>10.0f} moves/s {:>10.0f} setpoints/s {:>8.0f} s of motion per s\n", name,
             count / wall.count(), static_cast<double>(run.setpoints) / wall.count(),
             run.job_time / wall.count());
}

template <typename Program>
void measure_time(const char* name, double bound, Program program) {
  Run run;
  program(run);
  run.finish();
  fmt::print("{:<28} {:>9.4f} s, bound {:>8.4f} s, ratio {:.4f}, {} setpoints\n", name,
             run.job_time, bound, run.job_time / bound, run.setpoints);
}

struct Options {
  double tolerance = 0.02;
  double grid = 0.0005;
};

/// Time of the motion, and the least time for its path.
struct Measured {
  double time = 0.0;
  double bound = 0.0;
  std::size_t stops_on_curves = 0;

  [[nodiscard]] double ratio() const { return bound > 0.0 ? time / bound : 1.0; }
};

Measured measure_program(const bench::PathProgram& program, const Limits& how,
                         const Options& options) {
  const AxisLimits limits{Position::filled(how.velocity), Position::filled(how.acceleration)};
  Planner planner({.limits = limits}, {});
  motion::test::TimeBound bound(limits, {}, options.grid);
  Measured measured;
  bench::drive(planner, program, {.feed = how.feed, .tolerance = options.tolerance},
               [&](Planner& from) {
                 const auto setpoint = from.next();
                 if (!setpoint) return;
                 measured.time += setpoint->duration;
                 bound.take(*setpoint);
               });
  measured.bound = bound.seconds();
  measured.stops_on_curves = bound.stops_on_curves();
  return measured;
}

/// One row of the table; the largest ratio in it.
double measure_file(const std::string& file, const Options& options) {
  const bench::PathProgram program = bench::read_program(file);
  if (program.turns_rotary_axes || program.refused_lines > program.moves.size() / 100) return 0.0;
  fmt::print("| {} | {} |", program.name, program.moves.size());
  double worst = 0.0;
  std::size_t stops = 0;
  for (const Limits& limits : kLimits) {
    const Measured measured = measure_program(program, limits, options);
    fmt::print(" {:.2f} | {:.4f} |", measured.time, measured.ratio());
    worst = std::max(worst, measured.ratio());
    stops = std::max(stops, measured.stops_on_curves);
  }
  fmt::print("{}\n", stops > 0 ? fmt::format(" {} stops on curves", stops) : "");
  std::fflush(stdout);
  return worst;
}

void measure_files(const std::vector<std::string>& files, const Options& options) {
  fmt::print("| program, P {} mm | moves |", options.tolerance);
  for (const Limits& limits : kLimits) {
    fmt::print(" {}/{}/{} s | ratio |", limits.velocity, limits.acceleration, limits.feed);
  }
  fmt::print("\n|---|---:|");
  for (std::size_t i = 0; i < std::size(kLimits); ++i) fmt::print("---:|---:|");
  fmt::print("\n");
  double worst = 0.0;
  for (const std::string& file : files) worst = std::max(worst, measure_file(file, options));
  fmt::print("\nlargest ratio {:.4f}\n", worst);
}

void measure_synthetic() {
  measure_rate("lines of 0.5 mm", 200'000, chords);
  measure_rate("half circles of R 5 mm", 5'000, waves);

  // Four sides of 1.2 s.
  measure_time("square 100 mm, exact stop", 4.8, [](Run& run) {
    for (const Position& corner : {xyz(100, 0), xyz(100, 100), xyz(0, 100), xyz(0, 0)}) {
      run.line(corner);
    }
  });
  // The bound that trajcheck gives for this circle (peer-figures).
  measure_time("circle 100 mm, one G3", 3.340, [](Run& run) {
    run.arc({xyz(0, 0), Plane::xy, 50.0, 0.0, 1});
  });
  // 1000 chords of 0.314 mm, 0.36° between them: the circle's bound, if corners cost nothing.
  measure_time("circle 100 mm, 1000 chords", 3.340, [](Run& run) {
    for (int i = 1; i <= 1000; ++i) {
      const double phi = 2.0 * kPi * i / 1000.0;
      run.line(xyz(50.0 - 50.0 * std::cos(phi), -50.0 * std::sin(phi)));
    }
  });
}

}  // namespace

int main(int count, char** values) {
  Options options;
  std::vector<std::string> files;
  for (int i = 1; i < count; ++i) {
    const std::string_view argument = values[i];
    if (argument == "--help" || argument == "-h") {
      fmt::print("{}", kHelp);
      return 0;
    }
    if (argument.starts_with("p=")) {
      options.tolerance = std::atof(values[i] + 2);
    } else if (argument.starts_with("grid=")) {
      options.grid = std::atof(values[i] + 5);
    } else {
      files.emplace_back(argument);
    }
  }
  if (files.empty()) {
    measure_synthetic();
  } else {
    measure_files(files, options);
  }
}
