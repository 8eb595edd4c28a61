// Programs within limits of jerk: their time beside a reference of its own, and what planning
// costs.
//
//   jerk_bench [OPTION=VALUE ...] FILE ...
//
//   v=100 a=500     limits of every axis, mm/s and mm/s²
//   j=20000         limit of jerk, mm/s³
//   feed=100        one feed for all moves, mm/s
//   p=0.02          path tolerance (G64 P), mm
//   longest=60000   reference: runs of more cells are left out
//
// The reference plans each run, from standstill to standstill, as a whole: its cells a third as
// long, and its barriers a tenth as heavy in the end.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fmt/core.h>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motion/cell_motion.h"
#include "motion/jerk_profile.h"
#include "motion/smoother.h"
#include "tests/bench/bench_options.h"
#include "tests/bench/path_program.h"

namespace {

using namespace cnc;
using namespace cnc::motion;

using bench::Options;

/// A motion from standstill to standstill.
class Reference {
 public:
  Reference(const JerkLimits& limits, const std::vector<PathInterval>& run, std::size_t most_cells)
      : cutter_(limits, run.size() + 1), window_(most_cells) {
    for (const PathInterval& interval : run) cutter_.append(interval);
    cutter_.stop_at_end();
    cutter_.go_to({}, 0.0);
  }

  /// Nothing when there are too many cells or no plan is found.
  [[nodiscard]] std::optional<double> time() {
    start_length_ = cutter_.begin_run();
    window_.most_start_x = cutter_.reach_of({}, start_length_).standstill_x(start_length_);
    cutter_.skip(start_length_);
    if (!cut()) return std::nullopt;
    stop_length_ = cutter_.stop_length();
    window_.end.most_x = cutter_.reach_of(cutter_.place(), stop_length_).standstill_x(stop_length_);
    window_.end.knot.before =
        part_beside_standstill(window_.cells.back().cell.length, stop_length_);
    guess();
    window_.reset_weights(0);
    for (int i = 0; i < kMostRounds && window_.improve(0); ++i) {
    }
    for (int i = 0; i < kFineRounds; ++i) {
      for (std::uint64_t k = 0; k != window_.cells.end(); ++k) {
        window_.cells[k].weight *= kFinerWeight;
        window_.cells[k].least *= kFinerWeight;
      }
      for (int n = 0; n < 3; ++n) (void)window_.improve(0);
    }
    for (int i = 0; i < kMostRounds && window_.usage(0) > kUsageOfPlan; ++i) {
      window_.defend_harder(0);
      (void)window_.improve(0);
    }
    if (window_.usage(0) > kUsageOfPlan) return std::nullopt;
    return seconds();
  }

 private:
  static constexpr int kMostRounds = 200;
  static constexpr int kFineRounds = 8;
  static constexpr double kFinerWeight = 0.75;
  static constexpr int kParts = 3;

  bool cut() {
    while (const auto cell = cutter_.next()) {
      for (int i = 0; i < kParts; ++i) {
        if (window_.cells.free() == 0) return false;
        const double length = cell->length / kParts;
        push(cutter_.cell_at({cell->interval, cell->start + i * length}, length));
      }
    }
    return !window_.cells.empty();
  }

  void push(const SpeedCell& cell) {
    if (!window_.cells.empty()) {
      window_.cells.push_back(planned_behind(window_.cells.back(), cell));
    } else {
      PlannedCell planned;
      planned.cell = cell;
      planned.knot.behind = part_beside_standstill(cell.length, start_length_);
      window_.cells.push_back(planned);
    }
    window_.cells.back().wanted_x = cell.feed_x;
  }

  /// Second-order envelopes from both ends with half of the limits.
  void guess() {
    auto& cells = window_.cells;
    const auto forward = [](const SpeedCell& cell, double x, double way) {
      return std::min({x + 2.0 * way * cell.reach.moderate_w(x), cell.reach.cruise_x(0.5),
                       0.9 * cell.machine_x, 0.9 * cell.feed_x});
    };
    double x = 0.3 * window_.most_start_x;
    for (std::uint64_t i = 0; i != cells.end(); ++i) {
      x = forward(cells[i].cell, x, cells[i].cell.length);
      cells[i].x = x;
    }
    x = 0.3 * window_.end.most_x;
    for (std::uint64_t i = cells.end(); i-- > 0;) {
      x = std::min(forward(cells[i].cell, x, cells[i].cell.length), cells[i].x);
      cells[i].x = x;
    }
  }

  [[nodiscard]] double seconds() const {
    const CellX first = window_.x_of(0);
    const CellX last = window_.x_of(window_.cells.end() - 1);
    double time = StandstillMotion{start_length_, std::sqrt(first[0])}.duration() +
                  StandstillMotion{stop_length_, std::sqrt(last[2])}.duration();
    for (std::uint64_t i = 0; i != window_.cells.end(); ++i) {
      const CellX x = window_.x_of(i);
      const double h = window_.cells[i].cell.length;
      const CellMotion motion(std::sqrt(x[0]), (x[1] - x[0]) / h,
                              ((x[2] - x[1]) - (x[1] - x[0])) / (h * h));
      time += motion.time_to(h, std::sqrt(x[2]));
    }
    return time;
  }

  CellCutter cutter_;
  SpeedWindow window_;
  double start_length_ = 0.0;
  double stop_length_ = 0.0;
};

/// The runs of a program as the planner drives them.
class Runs {
 public:
  Runs(const bench::PathProgram& program, const AxisLimits& limits, const Options& options)
      : smoother_(limits, 1.0, 1e-3) {
    Position at;
    for (const bench::ProgramMove& move : program.moves) {
      if (move.is_arc) continue;
      Piece piece;
      piece.curve = Line(at, move.shape.end);
      piece.end = length_of(piece.curve);
      if (piece.end < kShortest) continue;
      at = move.shape.end;
      piece.kind = move.kind;
      piece.feed = options["feed"];
      piece.laf_angle = 1.0;
      piece.tolerance = options["p"];
      smoother_.add(piece);
      take();
    }
    smoother_.finish();
    take();
    end_run();
  }

  std::vector<std::vector<PathInterval>> all;

 private:
  void take() {
    for (; smoother_.ready(); smoother_.pop()) {
      const Piece& piece = smoother_.front();
      if (piece.entry != Entry::smooth) end_run();
      run_.push_back(interval_of(piece, piece.begin, piece.end - piece.begin));
      if (piece.entry == Entry::vertex || piece.stop_at_end) end_run();
    }
  }
  void end_run() {
    if (!run_.empty()) all.push_back(std::move(run_));
    run_.clear();
  }

  Smoother smoother_;
  std::vector<PathInterval> run_;
};

/// Time of the planner as it streams; seconds of the processor for all calls and for the longest.
struct Streamed {
  double time = 0.0;
  double longest_call = 0.0;
  double computing = 0.0;
};

Streamed stream(const bench::PathProgram& program, const AxisLimits& limits,
                const Options& options) {
  Streamed result;
  Planner planner({.limits = limits}, {});
  bench::drive(planner, program, {.feed = options["feed"], .tolerance = options["p"]},
               [&](Planner& from) {
                 const std::clock_t begin = std::clock();
                 const auto setpoint = from.next();
                 const double took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
                 result.longest_call = std::max(result.longest_call, took);
                 result.computing += took;
                 if (setpoint) result.time += setpoint->duration;
               });
  return result;
}

void measure(const std::string& file, const Options& options) {
  const bench::PathProgram program = bench::read_program(file);
  AxisLimits limits{Position::filled(options["v"]), Position::filled(options["a"])};
  const double without = stream(program, limits, options).time;
  limits.max_jerk = Position::filled(options["j"]);
  const Streamed streamed = stream(program, limits, options);
  double planned = 0.0;
  double reference = 0.0;
  std::size_t left_out = 0;
  const Runs runs(program, limits, options);
  const auto most_cells = static_cast<std::size_t>(options["longest"]);
  for (const auto& run : runs.all) {
    const auto least = Reference(jerk_limits(limits), run, most_cells).time();
    JerkPlan plan(jerk_limits(limits), std::max<std::size_t>(8192, run.size() + 1));
    for (const PathInterval& interval : run) plan.append(interval);
    plan.stop_at_end();
    double time = 0.0;
    while (!plan.idle()) {
      while (plan.due() && plan.plan()) {
      }
      time += plan.time_in_cell();
      plan.advance_to(plan.behind_cell(plan.place()));
      plan.forget_before(plan.place());
    }
    if (!least) {
      ++left_out;
      continue;
    }
    planned += time;
    reference += *least;
  }
  fmt::print("| {} | {:.2f} | {:.2f} | {:.3f} | {:.4f} | {}/{} | {:.1f} ms | {:.1f} % |\n",
             program.name, without, streamed.time, streamed.time / without, planned / reference,
             runs.all.size() - left_out, runs.all.size(), 1e3 * streamed.longest_call,
             100.0 * streamed.computing / streamed.time);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** values) {
  const Options options(
      {{"v", 100.0}, {"a", 500.0}, {"j", 20'000.0}, {"feed", 100.0}, {"p", 0.02}, {"longest", 6e4}},
      count, values);
  if (options.files().empty()) {
    fmt::print(
        "usage: jerk_bench [v=100] [a=500] [j=20000] [feed=100] [p=0.02] [longest=60000] "
        "FILE ...\n");
    return 2;
  }
  fmt::print(
      "| program | without | with jerk | ratio | planned over reference | runs compared | "
      "longest call | computing |\n|---|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const std::string& file : options.files()) measure(file, options);
}
