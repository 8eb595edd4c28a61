#include "tests/motion/program_text.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fmt/core.h>
#include <fmt/format.h>
#include <sstream>
#include <stdexcept>

namespace cnc::motion::test {

namespace {

std::string words_of(const Position& p) {
  std::string text;
  for (const Axis axis : kAllAxes) {
    if (p[axis] != 0.0) text += fmt::format(" {}{:.12g}", axis_name(axis), p[axis]);
  }
  return text;
}

std::string mode_of(const MoveOptions& options) {
  std::string text = options.tolerance > 0.0 ? fmt::format("G64 P{:.12g}", options.tolerance)
                     : options.stop_at_end   ? "G61.1"
                                             : "G61";
  if (options.simplify > 0.0) text += fmt::format(" Q{:.12g}", options.simplify);
  if (options.tolerance > 0.0 && options.stop_at_end) text += " (exact stop)";
  return text;
}

std::string move_of(const ProgramStep& step) {
  if (step.options.kind == MoveKind::rapid) return "G0" + words_of(step.way);
  const std::string feed = fmt::format(" F{:.12g}", 60.0 * step.options.feed);
  if (!step.is_arc) return "G1" + words_of(step.way) + feed;
  static constexpr const char* kPlanes[] = {"G17", "G18", "G19"};
  const PlaneAxes axes = axes_of(step.plane);
  const auto centre = [](Axis axis) { return "IJK"[index_of(axis)]; };
  return fmt::format("{} {}{} {}{:.12g} {}{:.12g}{}{}",
                     kPlanes[static_cast<std::size_t>(step.plane)], step.turns > 0 ? "G3" : "G2",
                     words_of(step.way), centre(axes.first), step.first_centre, centre(axes.second),
                     step.second_centre,
                     std::abs(step.turns) > 1 ? fmt::format(" (turns {})", step.turns) : "", feed);
}

std::string event_of(const ProgramStep& step) {
  std::string text = step.draws > 0 ? fmt::format("({} setpoints)\n", step.draws) : "";
  if (step.event == Event::hold) text += "(hold until standstill, resume)\n";
  if (step.event == Event::overrides) {
    text += fmt::format("(overrides: feed {:.12g}, rapid {:.12g})\n", step.feed_override,
                        step.rapid_override);
  }
  return text;
}

}  // namespace

std::string text_of(const RandomProgram& program) {
  const auto three = [](const Position& p) {
    return fmt::format("{:.12g} {:.12g} {:.12g}", p[Axis::X], p[Axis::Y], p[Axis::Z]);
  };
  const AxisLimits& limits = program.settings.limits;
  std::string text = fmt::format("(X Y Z: {} mm/s, {} mm/s2; setpoints of {:.12g} s)\n",
                                 three(limits.max_velocity), three(limits.max_acceleration),
                                 program.settings.max_setpoint_duration);
  if (limits.limit_jerk()) text += fmt::format("(jerk: {} mm/s3)\n", three(limits.max_jerk));
  text += "G21 G91\n";
  std::string mode;
  for (const ProgramStep& step : program.steps) {
    text += event_of(step);
    if (mode_of(step.options) != mode) text += (mode = mode_of(step.options)) + "\n";
    text += move_of(step) + "\n";
  }
  return text;
}

namespace {

/// What is in force for the moves that follow, and what waits for the next one.
class Reader {
 public:
  void line(const std::string& text) {
    if (text.empty() || text == "G21 G91") return;
    if (text.starts_with("(X Y Z:")) return limits(text);
    if (text.starts_with("(jerk:")) return jerk(text);
    if (text.front() == '(') return remark(text);
    if (text.starts_with("G6")) return mode(text);
    move(text);
  }
  [[nodiscard]] RandomProgram take() { return std::move(program_); }

 private:
  [[noreturn]] static void refuse(const std::string& text) {
    throw std::invalid_argument("not understood: " + text);
  }

  void limits(const std::string& text) {
    PlannerSettings& settings = program_.settings;
    settings.limits = {Position::filled(360.0), Position::filled(1800.0)};
    Position& v = settings.limits.max_velocity;
    Position& a = settings.limits.max_acceleration;
    const int count = std::sscanf(
        text.c_str(), "(X Y Z: %lf %lf %lf mm/s, %lf %lf %lf mm/s2; setpoints of %lf s)",
        &v[Axis::X], &v[Axis::Y], &v[Axis::Z], &a[Axis::X], &a[Axis::Y], &a[Axis::Z],
        &settings.max_setpoint_duration);
    if (count != 7) refuse(text);
  }

  void jerk(const std::string& text) {
    Position& j = program_.settings.limits.max_jerk;
    j = program_.settings.limits.max_acceleration * 20.0;
    const int count = std::sscanf(text.c_str(), "(jerk: %lf %lf %lf mm/s3)", &j[Axis::X],
                                  &j[Axis::Y], &j[Axis::Z]);
    if (count != 3) refuse(text);
  }

  void remark(const std::string& text) {
    if (std::sscanf(text.c_str(), "(%d setpoints)", &next_.draws) == 1) return;
    if (text.starts_with("(hold")) {
      next_.event = Event::hold;
    } else if (std::sscanf(text.c_str(), "(overrides: feed %lf, rapid %lf)", &next_.feed_override,
                           &next_.rapid_override) == 2) {
      next_.event = Event::overrides;
    } else {
      refuse(text);
    }
  }

  void mode(const std::string& text) {
    mode_ = {};
    mode_.stop_at_end = text.starts_with("G61.1") || text.find("(exact stop)") != text.npos;
    if (const auto p = text.find(" P"); p != text.npos) {
      mode_.tolerance = std::strtod(text.c_str() + p + 2, nullptr);
    }
    if (const auto q = text.find(" Q"); q != text.npos) {
      mode_.simplify = std::strtod(text.c_str() + q + 2, nullptr);
    }
  }

  void move(const std::string& text) {
    next_.options.tolerance = mode_.tolerance;
    next_.options.simplify = mode_.simplify;
    next_.options.stop_at_end = mode_.stop_at_end;
    next_.options.kind = MoveKind::feed;
    int direction = 0;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
      if (word == "(turns") {
        words >> next_.turns;
        direction = 0;
        break;
      }
      take_word(word, direction);
    }
    if (direction != 0) next_.turns = direction;
    if (const auto f = text.rfind('F'); f != text.npos) {
      next_.options.feed = std::strtod(text.c_str() + f + 1, nullptr) / 60.0;
    }
    program_.steps.push_back(next_);
    next_ = {};
  }

  void take_word(const std::string& word, int& direction) {
    const double value = std::strtod(word.c_str() + 1, nullptr);
    const PlaneAxes axes = axes_of(next_.plane);
    if (word == "G0") {
      next_.options.kind = MoveKind::rapid;
    } else if (word == "G2" || word == "G3") {
      next_.is_arc = true;
      direction = word == "G3" ? 1 : -1;
    } else if (word == "G17" || word == "G18" || word == "G19") {
      next_.plane = word == "G17" ? Plane::xy : word == "G18" ? Plane::xz : Plane::yz;
    } else if (const auto axis = axis_of_letter(word[0])) {
      next_.way[*axis] = value;
    } else if (word[0] == "IJK"[index_of(axes.first)]) {
      next_.first_centre = value;
    } else if (word[0] == "IJK"[index_of(axes.second)]) {
      next_.second_centre = value;
    } else if (word != "G1" && word[0] != 'F') {
      refuse(word);
    }
  }

  RandomProgram program_;
  ProgramStep next_;
  MoveOptions mode_;
};

}  // namespace

RandomProgram program_of(const std::string& text) {
  Reader reader;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) reader.line(line);
  return reader.take();
}

}  // namespace cnc::motion::test
