// Any bytes as a program, a macro file and a machine that answers anything. Every way to run a
// program ends in bounded time, every error names its line, and no command moves the machine to
// where no machine is.
//
// The input: three bytes that choose the settings, then the program, and behind a form feed the
// macro file; seeds/interpreter/ holds some. interpreter.dict has every code and statement.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "interpreter/check.h"

namespace {

using namespace cnc;
using namespace cnc::interp;

constexpr std::size_t kOptionBytes = 3;
constexpr std::uint64_t kMaxLines = 1'000;
constexpr std::size_t kMaxCommands = 20'000;

void require(bool condition) {
  if (!condition) std::abort();
}

struct Input {
  std::array<std::uint8_t, kOptionBytes> options{};
  std::string program;
  std::string macros;

  [[nodiscard]] bool option(unsigned bit) const { return (options[bit / 8] >> bit % 8 & 1) != 0; }
};

Input input_from(std::string_view bytes) {
  Input input;
  for (std::size_t i = 0; i < kOptionBytes && i < bytes.size(); ++i) {
    input.options[i] = static_cast<std::uint8_t>(bytes[i]);
  }
  bytes.remove_prefix(std::min(kOptionBytes, bytes.size()));
  const std::size_t form_feed = bytes.find('\f');
  input.program = bytes.substr(0, form_feed);
  if (form_feed != std::string_view::npos) input.macros = bytes.substr(form_feed + 1);
  return input;
}

InterpreterSettings settings_of(const Input& input) {
  InterpreterSettings settings;
  settings.dialect = input.option(0) ? DialectId::pscnc : DialectId::eding;
  settings.strict = input.option(1);
  settings.is_3d_printer = input.option(2);
  settings.diameter_programming = input.option(3);
  settings.front_tool_post = input.option(4);
  settings.absolute_arc_centres = input.option(8);
  settings.block_delete = input.option(9);
  settings.automatic_tool_change = !input.option(10);
  settings.default_unit = input.option(11) ? LengthUnit::inch : LengthUnit::millimetre;
  settings.machine.simulation = input.option(12);
  settings.machine.head_offset[static_cast<std::size_t>(Head::probe)][Axis::X] = 50.0;
  settings.lines_per_call = 100;
  settings.max_call_depth = 16;
  if (auto macros = Program::from_text(input.macros, "macro.cnc")) {
    settings.library.push_back(*macros);
  }
  return settings;
}

bool is_finite(const Position& position) {
  for (const Axis axis : kAllAxes) {
    if (!std::isfinite(position[axis])) return false;
  }
  return true;
}

/// Every position of a command is a place.
void check_command(const Command& command) {
  std::visit(
      []<typename Body>(const Body& body) {
        if constexpr (requires { Position{body.end}; }) require(is_finite(body.end));
        if constexpr (std::is_same_v<Body, ArcMove>) {
          require(std::isfinite(body.first_centre) && std::isfinite(body.second_centre));
        }
        if constexpr (std::is_same_v<Body, SetFeedRate>) require(std::isfinite(body.feed));
      },
      command.body);
  require(!text_of(command).empty());
}

/// What no machine and no operator should say, but a bug might.
class WildWorld {
 public:
  explicit WildWorld(std::uint8_t seed) : state_(seed) {}

  Answer answer(Answer expected) {
    if (state_ % 4 == 0) return expected;  // a world as it should be
    for (const Axis axis : kAllAxes) {
      if (next() % 8 == 0) expected.position[axis] = value();
      if (next() % 8 == 0) expected.probe_position[axis] = value();
    }
    expected.probe_tripped = next() % 2 == 0;
    expected.confirmed = next() % 2 == 0;
    expected.input = value();
    expected.live.hand_wheel = value();
    expected.live.spindle_speed = value();
    expected.values.resize(next() % 20);
    for (double& typed : expected.values) typed = value();
    return expected;
  }

 private:
  std::uint32_t next() { return state_ = state_ * 1664525U + 1013904223U, state_ >> 16U; }
  double value() {
    using Limits = std::numeric_limits<double>;
    static constexpr std::array kValues{0.0,
                                        1.0,
                                        -1.0,
                                        0.1,
                                        1e9,
                                        -1e10,
                                        1e300,
                                        Limits::max(),
                                        5e-324,
                                        Limits::infinity(),
                                        -Limits::infinity(),
                                        Limits::quiet_NaN()};
    return kValues[next() % kValues.size()];
  }

  std::uint32_t state_;
};

void run_as(RunMode mode, const Input& input, const std::shared_ptr<const Program>& program) {
  config::ParameterStore parameters;
  config::ToolTable tools;
  require(
      tools.set(1, {.length = 10, .diameter = 6, .orientation = 3, .description = {}}).has_value());
  Interpreter interpreter(settings_of(input), parameters, tools);
  interpreter.start(program, {}, {.mode = mode, .search_line = 1U + input.options[2]});
  WildWorld world(input.options[2]);
  bool searching = mode == RunMode::search;
  for (std::size_t commands = 0; commands < kMaxCommands; ++commands) {
    if (interpreter.lines_run() > kMaxLines) break;
    switch (interpreter.next()) {
      case Progress::command:
        require(!searching);
        check_command(interpreter.command());
        break;
      case Progress::working:
        break;
      case Progress::waiting:
        require(mode != RunMode::render);
        interpreter.answer(world.answer(interpreter.expected_answer()));
        break;
      case Progress::found:
        require(std::exchange(searching, false));
        interpreter.leave_search(interpreter.resume_point().position);
        break;
      case Progress::failed:
        require(!interpreter.diagnostic().to_string().empty());
        require(interpreter.skip_failed_line());
        break;
      case Progress::ended:
        require(is_finite(interpreter.position()));
        return;
    }
    require(is_finite(interpreter.position()));
  }
}

void check_whole(const Input& input, const std::shared_ptr<const Program>& program) {
  CheckOptions options;
  options.max_errors = 20;
  options.max_loop_lines = kMaxLines;
  options.sink = check_command;
  const CheckReport report = check(program, settings_of(input), {}, {}, {}, options);
  for (const Diagnostic& error : report.errors) {
    require(!error.to_string().empty());
    // An error that names no line is a bug; those in macro files have lines of their own.
    require(error.line != 0);
    require(error.file == "macro.cnc" || error.line <= report.line_count);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Input input = input_from({reinterpret_cast<const char*>(data), size});
  const auto program = Program::from_text(input.program, "fuzz");
  if (!program) return 0;
  for (const RunMode mode : {RunMode::run, RunMode::render, RunMode::search}) {
    run_as(mode, input, *program);
  }
  check_whole(input, *program);
  return 0;
}
