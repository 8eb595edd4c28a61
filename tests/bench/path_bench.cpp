// How long programs take with G64, how exactly they are followed, and how fast that is computed.
//
//   path_bench [OPTION=VALUE ...] FILE ...
//
//   v=100 a=500     limits of every axis, mm/s and mm/s²
//   j=0             limit of jerk, mm/s³; 0: none
//   feed=100        one feed for all moves, mm/s; 0: the program's own
//   p=0.02          path tolerance (G64 P), mm; 0: exact path
//   q=0             line simplification (G64 Q), mm
//   judge=1         also measure limits and distances
//   times=1         plan each program so many times over, for profiles
//
// Tools, spindle, dwells and the like take no time here: what is measured is motion.
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fmt/core.h>
#include <string>
#include <string_view>
#include <vector>

#include "motion/planner.h"
#include "motion/smoother.h"
#include "tests/bench/bench_options.h"
#include "tests/bench/path_program.h"
#include "tests/motion/path_judge.h"

namespace {

using namespace cnc;

using bench::Options;

bench::Driving driving_of(const Options& options) {
  return {options["feed"], options["p"], options["q"]};
}

void add_arc(motion::test::Polyline& path, const Position& start, const motion::ArcShape& shape) {
  const auto arc = motion::make_arc(start, shape);
  if (!arc) return;
  const int count =
      std::max(8, static_cast<int>(std::abs(arc->sweep()) * std::sqrt(arc->radius(0.0) / 8e-6)));
  for (int i = 1; i <= count; ++i)
    path.add(motion::test::point_of(arc->point(arc->length() * i / count)));
}

void judge(const bench::PathProgram& program, const motion::AxisLimits& limits,
           const Options& options) {
  const double cell = std::max(0.25, 3.0 * options["p"]);
  motion::test::Polyline programmed(cell);
  programmed.add({});
  Position at;
  for (const bench::ProgramMove& move : program.moves) {
    if (move.is_arc) {
      add_arc(programmed, at, move.shape);
    } else {
      programmed.add(motion::test::point_of(move.shape.end));
    }
    at = move.shape.end;
  }
  motion::test::Polyline driven(cell);
  driven.add({});
  motion::test::LimitJudge judge{.limits = limits, .position = {}, .velocity = {}};
  motion::Planner whole({.limits = limits}, {});
  bench::drive(whole, program, driving_of(options), [&](motion::Planner& planner) {
    const auto drawn = planner.next();
    if (!drawn) return;
    const motion::Setpoint& setpoint = *drawn;
    const auto point_at = [&](double t) {
      Position p;
      for (const Axis axis : kLinearAxes) {
        p[axis] = motion::cubic_of(axis, judge.position, judge.velocity, setpoint).position(t);
      }
      return motion::test::point_of(p);
    };
    // Chords that leave the cubic by a three-thousandth of the tolerance.
    const double height = motion::test::distance_to_segment(
        point_at(0.5 * setpoint.duration), driven.points().back(), point_at(setpoint.duration));
    const double chord_error = std::max(options["p"] / 3000.0, 1e-6);
    const int parts = 1 + static_cast<int>(std::sqrt(height / chord_error));
    for (int i = 1; i <= parts; ++i) driven.add(point_at(setpoint.duration * i / parts));
    judge.take(setpoint);
  });
  fmt::print(
      "{:<28} {:>9.3f} s  v {:.5f} a {:.5f} j {:.5f} feed {:.5f}  path to program {:.5f} mm, back "
      "{:.5f} mm, {} setpoints, the shortest {:.6f} s, leap {:.5f}\n",
      program.name, judge.time, judge.velocity_ratio, judge.acceleration_ratio, judge.jerk_ratio,
      judge.feed_ratio, motion::test::largest_distance(driven, programmed),
      motion::test::largest_distance(programmed, driven), judge.setpoints, judge.shortest,
      judge.leap_ratio);
}

/// Moves per second that are smoothed, without being timed: what one of two threads would do.
double smoothing_rate(const bench::PathProgram& program, const motion::AxisLimits& limits,
                      const bench::Driving& driving) {
  motion::Smoother smoother(limits);
  Position at;
  const std::clock_t begin = std::clock();
  for (const bench::ProgramMove& move : program.moves) {
    motion::Piece piece;
    piece.kind = move.kind;
    piece.feed = driving.feed > 0.0 ? driving.feed : move.feed;
    piece.tolerance = driving.tolerance;
    if (move.is_arc) {
      const auto arc = motion::make_arc(at, move.shape);
      if (!arc) continue;
      piece.curve = *arc;
    } else {
      piece.curve = motion::Line(at, move.shape.end);
    }
    piece.end = motion::length_of(piece.curve);
    at = move.shape.end;
    if (piece.end < motion::kShortest) continue;
    smoother.add(piece);
    while (smoother.ready()) smoother.pop();
  }
  smoother.finish();
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return static_cast<double>(program.moves.size()) / seconds;
}

void measure(const std::string& path, const Options& options) {
  const bench::PathProgram program = bench::read_program(path);
  const motion::AxisLimits limits{Position::filled(options["v"]), Position::filled(options["a"]),
                                  Position::filled(options["j"])};
  const auto rate = [&](auto draw) {
    double time = 0.0;
    motion::Planner whole({.limits = limits}, {});
    const std::clock_t begin = std::clock();
    bench::drive(whole, program, driving_of(options), [&](motion::Planner& planner) {
      if (const auto part = draw(planner)) time += part->duration;
    });
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    return std::pair(time, static_cast<double>(program.moves.size()) / seconds);
  };
  for (double i = 1.0; i < options["times"]; ++i) {
    (void)rate([](motion::Planner& planner) { return planner.skip(); });
  }
  const auto [predicted, plan_rate] = rate([](motion::Planner& planner) { return planner.skip(); });
  double rapids = 0.0;
  const auto [time, rate_all] = rate([&](motion::Planner& planner) {
    auto setpoint = planner.next();
    if (setpoint && setpoint->feed_limit == 0.0) rapids += setpoint->duration;
    return setpoint;
  });
  const double smoothed = smoothing_rate(program, limits, driving_of(options));
  fmt::print(
      "{:<28} {:>9.3f} s, {:.2f} s of it rapids, predicted {:>9.3f} s; {} moves, planned "
      "{:>7.0f}/s "
      "(smoothing alone {:>7.0f}/s), with setpoints {:>7.0f}/s\n",
      program.name, time, rapids, predicted, program.moves.size(), plan_rate, smoothed, rate_all);
  if (options["judge"] != 0.0) judge(program, limits, options);
}

}  // namespace

int main(int count, char** values) {
  const Options options({{"v", 100.0},
                         {"a", 500.0},
                         {"j", 0.0},
                         {"feed", 100.0},
                         {"p", 0.02},
                         {"q", 0.0},
                         {"judge", 1.0},
                         {"times", 1.0}},
                        count, values);
  for (const std::string& file : options.files()) measure(file, options);
}
