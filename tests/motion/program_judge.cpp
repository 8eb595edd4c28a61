#include "tests/motion/program_judge.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <vector>

#include "tests/motion/path_judge.h"
#include "tests/motion/program_text.h"
#include "tests/motion/shrink.h"

namespace cnc::motion::test {

namespace {

/// What an exact path may be beside the program: blends of a tenth of a micrometre, twice; with
/// limits of jerk, a micrometre (docs/path.md).
constexpr double kExact = 2e-4;
constexpr double kExactWithJerk = 1e-3;

/// Path and program are sampled so finely that the chords leave them by no more, mm.
double chord_error(double allowed) { return std::max(0.003 * allowed, 1e-5); }

/// A planner at work on a program, with the judges that look at what it does.
class Drive {
 public:
  Drive(const RandomProgram& program, const PlannerSettings& settings)
      : program_(program),
        planner_(settings, {}),
        exact_(settings.limits.limit_jerk() ? kExactWithJerk : kExact),
        programmed_(cell_of()),
        driven_(cell_of()),
        judge_{.limits = program.settings.limits, .position = {}, .velocity = {}} {
    programmed_.add({});
    driven_.add({});
    driven_.add({});  // a stretch of no length, for a program that moves nothing
  }

  Verdict run() {
    for (index_ = 0; index_ < program_.size() && verdict_.fault.empty(); ++index_) {
      const ProgramStep& step = program_.steps[index_];
      act(step);
      add(step);
      while (planner_.full() && verdict_.fault.empty()) {
        if (!draw(Supply::coming)) set_overrides(1.0, 1.0);
      }
    }
    set_overrides(1.0, 1.0);
    while (draw(Supply::ended)) continue;
    return finish();
  }

 private:
  [[nodiscard]] double allowed_by(const MoveOptions& options) const {
    if (options.kind == MoveKind::rapid) return exact_;
    return options.simplify + (options.tolerance > 0.0 ? options.tolerance : exact_);
  }

  [[nodiscard]] double cell_of() const {
    double largest = 0.0;
    double way = 0.0;
    for (const ProgramStep& step : program_.steps) {
      largest = std::max(largest, allowed_by(step.options));
      way += norm(step.way);
    }
    const double mean = way / static_cast<double>(std::max<std::size_t>(program_.size(), 1));
    return std::max({3.0 * largest, 0.5 * mean, 1e-3});
  }

  void act(const ProgramStep& step) {
    for (int i = 0; i < step.draws; ++i) {
      if (!draw(Supply::ended)) break;
    }
    if (step.event == Event::overrides) {
      set_overrides(step.feed_override, step.rapid_override);
    } else if (step.event == Event::hold) {
      planner_.hold();
      while (draw(Supply::coming)) continue;
      planner_.resume();
    }
  }

  void set_overrides(double feed, double rapid) {
    planner_.set_overrides(feed, rapid);
    judge_.set_feed_override(feed);
  }

  void add(const ProgramStep& step) {
    add_move(step);
    vertices_.push_back(point_of(planner_.queue_end()));
  }

  void add_move(const ProgramStep& step) {
    const Position start = planner_.queue_end();
    MoveOptions options = step.options;
    options.tag.id = index_;
    const double allowed = allowed_by(options);
    const Position end = start + step.way;
    if (!step.is_arc) {
      if (!planner_.add_line(end, options)) return refuse();
      sample(programmed_.points().back(), point_of(end), allowed);
      programmed_.add(point_of(end), allowed);
      return;
    }
    const PlaneAxes axes = axes_of(step.plane);
    const ArcShape shape{end, step.plane, start[axes.first] + step.first_centre,
                         start[axes.second] + step.second_centre, step.turns};
    const auto arc = make_arc(start, shape);
    if (!arc || !planner_.add_arc(shape, options)) return refuse();
    // The height of a chord is R φ²/8.
    const double radius = std::max(arc->radius(0.0), arc->radius(arc->length()));
    const double angle = std::sqrt(8.0 * chord_error(allowed) / radius);
    const int chords = 1 + static_cast<int>(std::abs(arc->sweep()) / angle);
    for (int i = 1; i <= chords; ++i) {
      const Point point = point_of(arc->point(arc->length() * i / chords));
      samples_.push_back({point, allowed});
      programmed_.add(point, allowed);
    }
  }
  void refuse() { ++verdict_.refused; }

  /// Points of a line that the path has to come near; at its ends what the neighbour allows counts
  /// as well.
  void sample(const Point& from, const Point& to, double allowed) {
    double length = 0.0;
    for (std::size_t k = 0; k < 3; ++k) length += (to[k] - from[k]) * (to[k] - from[k]);
    const int parts = 1 + std::min(12, static_cast<int>(std::sqrt(length) / allowed));
    if (!samples_.empty()) samples_.back().allowed = std::max(samples_.back().allowed, allowed);
    for (int i = 1; i <= parts; ++i) {
      Point point{};
      for (std::size_t k = 0; k < 3; ++k) point[k] = from[k] + (to[k] - from[k]) * i / parts;
      samples_.push_back({point, allowed});
    }
  }

  bool draw(Supply supply) {
    const auto setpoint = planner_.next(supply);
    if (!setpoint) return false;
    for (const Axis axis : kAllAxes) {
      if (std::isfinite(setpoint->position[axis]) && std::isfinite(setpoint->velocity[axis])) {
        continue;
      }
      verdict_.fault = "a setpoint that is not a number";
      return false;
    }
    follow(*setpoint);
    Setpoint judged = *setpoint;
    judged.feed_limit = feed_near(*setpoint);
    judge_.take(judged);
    return true;
  }

  /// Where one move becomes the next is known to within the tube only: the highest feed of the
  /// moves that begin or end so near counts; 0, no limit, where one of them is a rapid.
  [[nodiscard]] double feed_near(const Setpoint& setpoint) const {
    const Point here = point_of(setpoint.position);
    const auto is_near = [&](std::size_t vertex) {
      const double reach = 3.0 * allowed_by(program_.steps[vertex].options);
      return distance_to_segment(here, vertices_[vertex], vertices_[vertex]) <= reach;
    };
    std::size_t first = setpoint.tag.id;
    std::size_t last = first;
    while (first > 0 && is_near(first)) --first;
    while (last + 1 < vertices_.size() - 1 && is_near(last + 1)) ++last;
    double highest = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      if (program_.steps[i].options.kind == MoveKind::rapid) return 0.0;
      highest = std::max(highest, program_.steps[i].options.feed);
    }
    return highest;
  }

  /// The cubic as chords, so short that they leave it by little of what the moves here allow.
  void follow(const Setpoint& setpoint) {
    const auto at = [&](double t) {
      Position p;
      for (const Axis axis : kLinearAxes) {
        p[axis] = cubic_of(axis, judge_.position, judge_.velocity, setpoint).position(t);
      }
      return point_of(p);
    };
    const std::size_t move = setpoint.tag.id;
    double allowed = allowed_by(program_.steps[move].options);
    if (move > 0) allowed = std::min(allowed, allowed_by(program_.steps[move - 1].options));
    const double height = distance_to_segment(at(0.5 * setpoint.duration), driven_.points().back(),
                                              point_of(setpoint.position));
    const int parts = 1 + std::min(200, static_cast<int>(std::sqrt(height / chord_error(allowed))));
    for (int i = 1; i <= parts; ++i) driven_.add(at(setpoint.duration * i / parts));
  }

  Verdict finish() {
    verdict_.velocity = judge_.velocity_ratio;
    verdict_.acceleration = judge_.acceleration_ratio;
    verdict_.jerk = judge_.jerk_ratio;
    verdict_.feed = judge_.feed_ratio;
    verdict_.feed_may_wait = judge_.limits.limit_jerk();
    verdict_.time = judge_.time;
    verdict_.setpoints = judge_.setpoints;
    if (programmed_.points().size() > 1) measure_distances();
    if (!verdict_.fault.empty()) return verdict_;
    if (!planner_.idle()) verdict_.fault = "it does not come to its end";
    if (judge_.position != planner_.queue_end()) verdict_.fault = "it does not end where it should";
    if (judge_.velocity != Position{}) verdict_.fault = "it ends while moving";
    return verdict_;
  }

  void measure_distances() {
    for (const Point& point : driven_.points()) {
      double& largest = verdict_.path_to_program;
      largest = std::max(largest, programmed_.distance(point, largest));
    }
    for (const Sample& sample : samples_) {
      double& largest = verdict_.program_to_path;
      const double distance = driven_.distance(sample.point, largest * sample.allowed);
      largest = std::max(largest, distance / sample.allowed);
    }
  }

  struct Sample {
    Point point;
    double allowed;
  };

  const RandomProgram& program_;
  Planner planner_;
  double exact_;
  Polyline programmed_;
  Polyline driven_;
  std::vector<Sample> samples_;
  std::vector<Point> vertices_{Point{}};  // where each move begins, and the last one ends
  LimitJudge judge_;
  Verdict verdict_;
  std::size_t index_ = 0;
};

}  // namespace

bool Verdict::is_sound() const {
  return velocity <= 1.0 + 1e-6 && (feed <= 1.0 + 1e-6 || feed_may_wait) &&
         acceleration <= 1.0 + 1e-4 && jerk <= 1.0 + 1e-4 && path_to_program <= 1.0 &&
         program_to_path <= 1.0 && fault.empty();
}

std::string Verdict::to_string() const {
  return fmt::format(
      "velocity {:.6f}, acceleration {:.6f}, jerk {:.6f}, feed {:.6f}, path to program {:.4f}, "
      "program to path {:.4f}{}{}",
      velocity, acceleration, jerk, feed, path_to_program, program_to_path,
      fault.empty() ? "" : "; ", fault);
}

Verdict judge(const RandomProgram& program) { return judge(program, program.settings.limits); }

Verdict judge(const RandomProgram& program, const AxisLimits& planned_with) {
  PlannerSettings settings = program.settings;
  settings.limits = planned_with;
  return Drive(program, settings).run();
}

std::string smallest_failure(const RandomProgram& program) {
  const RandomProgram smallest =
      shrink(program, [](const RandomProgram& p) { return !judge(p).is_sound(); });
  return text_of(smallest) + judge(smallest).to_string();
}

}  // namespace cnc::motion::test
