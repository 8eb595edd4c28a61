#include "interpreter/check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "interpreter/contour.h"

namespace cnc::interp {

void Extents::add(Axis axis, double value) {
  lowest[axis] = std::min(lowest[axis], value);
  highest[axis] = std::max(highest[axis], value);
}

void Extents::add(const Position& position) {
  if (std::exchange(empty, false)) {
    lowest = highest = position;
    return;
  }
  for (const Axis axis : kAllAxes) add(axis, position[axis]);
}

namespace {

/// Whether `direction` lies on the way from `from` to `to`, counter-clockwise and less than once
/// around.
[[nodiscard]] bool is_passed(PlanePoint direction, PlanePoint from, PlanePoint to) {
  const bool at_most_half = cross(from, to) >= 0.0;
  if (at_most_half) return cross(from, direction) >= 0.0 && cross(direction, to) >= 0.0;
  return cross(to, direction) <= 0.0 || cross(direction, from) <= 0.0;
}

/// Adds the points where an arc turns back along an axis: every quarter of the circle that it
/// passes.
void add_quadrants(CheckReport& report, const Position& start, const ArcMove& arc) {
  constexpr std::array<PlanePoint, 4> kQuarters{{{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}};
  const PlaneAxes axes = axes_of(arc.plane);
  const PlanePoint centre{arc.first_centre, arc.second_centre};
  const PlanePoint from = in_plane(arc.turns > 0 ? start : arc.end, arc.plane) - centre;
  const PlanePoint to = in_plane(arc.turns > 0 ? arc.end : start, arc.plane) - centre;
  // A little spiral (rounded centres) stays within its larger radius.
  const double radius = std::sqrt(std::max(dot(from, from), dot(to, to)));
  const bool full = std::abs(arc.turns) > 1 || distance(from, to) < kSamePoint;
  for (const PlanePoint quarter : kQuarters) {
    if (!full && !is_passed(quarter, from, to)) continue;
    const bool on_first = quarter.first != 0.0;
    const Axis axis = on_first ? axes.first : axes.second;
    const double value =
        on_first ? centre.first + radius * quarter.first : centre.second + radius * quarter.second;
    report.motion.add(axis, value);
    report.cutting.add(axis, value);
  }
}

class Checker {
 public:
  Checker(const CheckOptions& options, Interpreter& interpreter, std::string name)
      : options_(options),
        interpreter_(interpreter),
        name_(std::move(name)),
        position_(interpreter.position()) {
    report_.motion.add(position_);
  }

  CheckReport run(const Program& program) {
    report_.line_count = program.line_count();
    while (go_on()) {
      switch (interpreter_.next()) {
        case Progress::command:
          use(interpreter_.command());
          break;
        case Progress::working:
        case Progress::waiting:
        case Progress::found:
          break;
        case Progress::failed:
          add_error(interpreter_.diagnostic());
          if (report_.errors.size() >= options_.max_errors) return std::move(report_);
          interpreter_.skip_failed_line();
          break;
        case Progress::ended:
          report_.complete = true;
          add_warnings();
          if (interpreter_.ran_off_end()) note_missing_end(program);
          return std::move(report_);
      }
    }
    return std::move(report_);
  }

 private:
  bool go_on() {
    if (options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed)) {
      report_.cancelled = true;
      return false;
    }
    if (options_.progress && interpreter_.lines_run() >= next_progress_) tell_progress();
    const std::uint64_t most = options_.max_loop_lines;
    if (most == 0 || interpreter_.lines_since_new() < most) return true;
    add_warning(ErrorCode::check_incomplete, interpreter_.next_line(),
                fmt::format("The check was given up after {} lines in loops and subs without "
                            "coming to a new line.",
                            most),
                "A loop that ends, or more lines with cncsim check --max-loop-lines.");
    return false;
  }

  void tell_progress() {
    constexpr std::uint64_t kEvery = 10'000;
    next_progress_ = interpreter_.lines_run() + kEvery;
    options_.progress(
        {interpreter_.next_line(), interpreter_.lines_run(), interpreter_.lines_since_new()});
  }

  void use(const Command& command) {
    ++report_.commands;
    if (const auto* rapid = std::get_if<RapidMove>(&command.body)) {
      move(rapid->end);
    } else if (const auto* feed = std::get_if<FeedMove>(&command.body)) {
      cut(feed->end);
    } else if (const auto* thread = std::get_if<SyncMove>(&command.body)) {
      cut(thread->end);
    } else if (const auto* probe = std::get_if<ProbeMove>(&command.body)) {
      move(probe->end);
    } else if (const auto* arc = std::get_if<ArcMove>(&command.body)) {
      begin_cut();
      add_quadrants(report_, position_, *arc);
      cut(arc->end);
    }
    if (options_.sink) options_.sink(command);
  }

  /// Where a cut begins belongs to it; a cut behind another begins at its end.
  void begin_cut() {
    feed_was_missed_ = false;
    if (!std::exchange(is_cutting_, true)) report_.cutting.add(position_);
  }

  void cut(const Position& end) {
    begin_cut();
    report_.cutting.add(end);
    arrive(end);
  }

  void move(const Position& end) {
    is_cutting_ = false;
    arrive(end);
  }

  void arrive(const Position& end) {
    report_.motion.add(end);
    position_ = end;
  }

  // No line with a feed move can be right until F is there: that is one error.
  void add_error(const Diagnostic& diagnostic) {
    const bool lacks_feed = diagnostic.code == ErrorCode::feed_not_set;
    if (lacks_feed && std::exchange(feed_was_missed_, true)) return;
    if (!seen_.insert({diagnostic.file, diagnostic.line, diagnostic.code}).second) return;
    report_.errors.push_back(diagnostic);
  }

  void add_warning(ErrorCode code, std::uint32_t line, std::string sentence,
                   std::string allowed = {}) {
    Diagnostic warning;
    warning.code = code;
    warning.severity = Severity::warning;
    warning.sentence = std::move(sentence);
    warning.allowed = std::move(allowed);
    warning.file = name_;
    warning.line = line;
    report_.warnings.push_back(std::move(warning));
  }

  void add_warnings() {
    for (const Diagnostic& warning : interpreter_.warnings()) report_.warnings.push_back(warning);
  }

  void note_missing_end(const Program& program) {
    add_warning(ErrorCode::no_program_end, program.line_count(),
                "The program ends without M2 or M30.");
  }

  const CheckOptions& options_;
  Interpreter& interpreter_;
  std::string name_;
  Position position_;
  bool is_cutting_ = false;       ///< up to position_
  bool feed_was_missed_ = false;  ///< said, and no move at feed rate since
  std::uint64_t next_progress_ = 0;
  CheckReport report_;
  std::set<std::tuple<std::string, std::uint32_t, ErrorCode>> seen_;
};

}  // namespace

CheckReport check(std::shared_ptr<const Program> program, const InterpreterSettings& settings,
                  config::ParameterStore parameters, config::ToolTable tools, const Position& start,
                  const CheckOptions& options) {
  Interpreter interpreter(settings, parameters, tools);
  if (options.begins_with) interpreter.set_state(*options.begins_with);
  interpreter.start(program, start, {.mode = RunMode::render});
  return Checker(options, interpreter, program->name()).run(*program);
}

}  // namespace cnc::interp
