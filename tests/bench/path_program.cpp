#include "tests/bench/path_program.h"

#include <cstdlib>
#include <fmt/core.h>

#include "interpreter/interpreter.h"

namespace cnc::bench {

namespace {

/// Collects the moves among the canonical commands.
class Collector {
 public:
  explicit Collector(PathProgram& program) : program_(program) {}

  void take(const interp::CommandBody& body) {
    if (const auto* set = std::get_if<interp::SetFeedRate>(&body)) feed_ = set->feed;
    if (const auto* rapid = std::get_if<interp::RapidMove>(&body)) {
      add({motion::MoveKind::rapid, 0.0, false, {.end = rapid->end}});
    } else if (const auto* line = std::get_if<interp::FeedMove>(&body)) {
      add({motion::MoveKind::feed, feed_, false, {.end = line->end}});
    } else if (const auto* arc = std::get_if<interp::ArcMove>(&body)) {
      add({motion::MoveKind::feed,
           feed_,
           true,
           {arc->end, arc->plane, arc->first_centre, arc->second_centre, arc->turns}});
    }
  }

 private:
  void add(const ProgramMove& move) {
    for (const Axis axis : kRotaryAxes) {
      if (move.shape.end[axis] != 0.0) program_.turns_rotary_axes = true;
    }
    program_.moves.push_back(move);
  }

  PathProgram& program_;
  double feed_ = 0.0;
};

}  // namespace

PathProgram read_program(const std::string& file) {
  const auto source = interp::Program::open(file);
  if (!source) {
    fmt::print("{}\n", source.error().to_string());
    std::exit(1);
  }
  config::ParameterStore parameters;
  config::ToolTable tools;
  interp::Interpreter interpreter({}, parameters, tools);
  interpreter.start(*source, {}, {.mode = interp::RunMode::render});
  PathProgram program;
  program.name = file.substr(file.rfind('/') + 1);
  Collector collector(program);
  for (;;) {
    switch (interpreter.next()) {
      case interp::Progress::command:
        collector.take(interpreter.command().body);
        break;
      case interp::Progress::waiting:
        interpreter.answer(interpreter.expected_answer());
        break;
      case interp::Progress::failed:
        ++program.refused_lines;
        if (!interpreter.skip_failed_line()) return program;
        break;
      case interp::Progress::ended:
        return program;
      case interp::Progress::working:
      case interp::Progress::found:
        break;
    }
  }
}

bool add_move(motion::Planner& planner, const ProgramMove& move, const Driving& driving) {
  motion::MoveOptions how;
  how.kind = move.kind;
  how.feed = driving.feed > 0.0 ? driving.feed : move.feed;
  how.tolerance = driving.tolerance;
  how.simplify = driving.simplify;
  const auto added =
      move.is_arc ? planner.add_arc(move.shape, how) : planner.add_line(move.shape.end, how);
  if (!added) fmt::print(stderr, "refused: {}\n", added.error().to_string());
  return added.has_value();
}

}  // namespace cnc::bench
