#include "tests/interpreter/support.h"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <sstream>

namespace cnc::interp::test {
namespace {

struct ShortText {
  std::string operator()(const RapidMove& c) const { return "rapid" + point(c.end); }
  std::string operator()(const FeedMove& c) const { return "feed" + point(c.end); }
  std::string operator()(const ArcMove& c) const {
    return fmt::format("arc{} around {:g} {:g} {}", point(c.end), shown(c.first_centre),
                       shown(c.second_centre), c.turns < 0 ? "cw" : "ccw");
  }
  std::string operator()(const ProbeMove& c) const { return "probe" + point(c.end); }
  std::string operator()(const SyncMove& c) const {
    return fmt::format("thread{} by {:g}", point(c.end), c.pitch);
  }
  std::string operator()(const Dwell& c) const { return fmt::format("dwell {:g}", c.duration); }
  std::string operator()(const TurnSpindle& c) const {
    return c.direction == SpindleDirection::off         ? "spindle off"
           : c.direction == SpindleDirection::clockwise ? "spindle cw"
                                                        : "spindle ccw";
  }
  std::string operator()(const OrientSpindle&) const { return "orient"; }
  std::string operator()(const ProgramStop&) const { return "stop"; }
  template <typename Other>
  std::string operator()(const Other&) const {
    return {};
  }

 private:
  static std::string point(const Position& p) {
    return fmt::format(" {:g} {:g} {:g}", shown(p[Axis::X]), shown(p[Axis::Y]), shown(p[Axis::Z]));
  }
  /// No traces of rounding: 1e-16 and -0 are 0.
  static double shown(double value) { return std::abs(value) < 1e-9 ? 0.0 : value; }
};

}  // namespace

std::string moves_of(Bench& bench, std::string_view text) {
  std::vector<std::string> moves;
  CheckOptions options;
  options.sink = [&](const Command& command) {
    if (std::string move = std::visit(ShortText{}, command.body); !move.empty()) {
      moves.push_back(std::move(move));
    }
  };
  const auto program = Program::from_text(std::string(text), "test.ngc").value();
  const CheckReport report =
      check(program, bench.settings, bench.parameters, bench.tools, bench.start, options);
  if (!report.errors.empty()) return report.errors[0].to_string();
  return fmt::format("{}", fmt::join(moves, "; "));
}

std::string moves_of(std::string_view text) {
  Bench bench;
  return moves_of(bench, text);
}

Outcome Bench::run(std::string_view text, std::size_t max_commands) {
  Outcome outcome;
  const auto program = Program::from_text(std::string(text), "test.ngc");
  if (!program) {
    outcome.failed = true;
    outcome.diagnostic.code = program.error().code;
    outcome.diagnostic.sentence = program.error().message;
    return outcome;
  }
  Interpreter interpreter(settings, parameters, tools);
  outcome.library_warnings = interpreter.library_warnings();
  interpreter.set_tool_in_spindle(tool_in_spindle);
  interpreter.start(*program, start, {.mode = mode});
  while (outcome.lines.size() < max_commands) {
    const Progress progress = interpreter.next();
    if (progress == Progress::command)
      outcome.lines.push_back(interp::text_of(interpreter.command()));
    if (progress == Progress::waiting) {
      Answer answer = interpreter.expected_answer();
      interpreter.answer(world ? world(interpreter.command(), answer) : answer);
    }
    if (progress == Progress::failed) {
      outcome.failed = true;
      outcome.diagnostic = interpreter.diagnostic();
    }
    if (progress == Progress::failed || progress == Progress::ended) break;
  }
  outcome.modal = interpreter.modal();
  outcome.position = interpreter.position();
  outcome.total_offset = interpreter.total_offset();
  outcome.warnings = interpreter.warnings();
  return outcome;
}

Outcome run(std::string_view text) { return Bench{}.run(text); }

void Bench::add_macros(std::string_view text, std::string name) {
  settings.library.push_back(Program::from_text(std::string(text), std::move(name)).value());
}

std::string text_of(const Outcome& outcome) {
  if (outcome.failed) return outcome.diagnostic.to_string();
  std::vector<std::string> lines = outcome.lines;
  if (!lines.empty() && lines.back() == "PROGRAM_END()") lines.pop_back();
  return fmt::format("{}", fmt::join(lines, "; "));
}

std::string commands_of(std::string_view text) { return text_of(run(text)); }

std::string refusal_of(std::string_view text) { return refusal_of(run(text)); }

std::string refusal_of(const Outcome& outcome) {
  if (!outcome.failed) return {};
  return fmt::format("{}@{}", error_info(outcome.diagnostic.code).name, outcome.diagnostic.column);
}

Position end_of(std::string_view text) {
  const Outcome outcome = run(text);
  if (outcome.failed) throw std::runtime_error(outcome.diagnostic.to_string());
  return outcome.position;
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace cnc::interp::test
