// Commands to the machine: reset, home, accept, jog, mdi, sub, override, zero, estop.
#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "api/cncctl/asker.h"
#include "api/cncctl/command_line.h"
#include "api/cncctl/json.h"
#include "api/cncctl/report.h"
#include "api/cncctl/text.h"
#include "api/cncctl/words.h"

namespace cnc::ctl {
namespace {

constexpr double kPercent = 0.01;

/// The axis that a word of the command line names; a usage error for any other word.
api::Axis parse_axis(std::string_view word) {
  const auto axis = word.size() == 1 ? api::axis_of_letter(word[0]) : std::nullopt;
  if (!axis) throw CLI::ValidationError(fmt::format("\"{}\" is not an axis: X Y Z A B C", word));
  return *axis;
}

/// "X" is X=0; "Y=2.5".
api::WorkCoordinate parse_coordinate(std::string_view word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string_view::npos) return {parse_axis(word), 0.0};
  return {parse_axis(word.substr(0, equals)), parse_number(word.substr(equals + 1))};
}

std::vector<api::Axis> parse_axes(const std::vector<std::string>& words) {
  std::vector<api::Axis> axes;
  for (const std::string& word : words) axes.push_back(parse_axis(word));
  return axes;
}

void add_home(CLI::App& app, Task& task) {
  CLI::App& home = *app.add_subcommand("home", "Home axes and wait until they are homed");
  const auto words = std::make_shared<std::vector<std::string>>();
  home.add_option("axes", *words, "X … C; none: all, Z first")->type_name("AXIS");
  home.callback([&task, words] {
    const std::vector<api::Axis> axes = parse_axes(*words);
    task.when_interrupted =
        "the machine stops; the axis in motion and those after it are not homed";
    task.action = [axes](const Context& context) {
      return done(
          while_asking(context, [&] { return context.client.home(axes, context.interrupted); }));
    };
  });
}

void add_accept(CLI::App& app, Task& task) {
  CLI::App& accept = *app.add_subcommand(
      "accept", "Trust the positions of axes again: you have checked where they stand");
  const auto words = std::make_shared<std::vector<std::string>>();
  accept.add_option("axes", *words, "X … C; none: all that are not trusted")->type_name("AXIS");
  accept.callback([&task, words] {
    task.action = [axes = parse_axes(*words)](const Context& context) {
      return done(context.client.accept_position(axes));
    };
  });
}

api::Result<void> execute_lines(const Context& context, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    if (auto result = context.client.mdi(line, context.interrupted); !result) return result;
  }
  return {};
}

void add_mdi(CLI::App& app, Task& task) {
  CLI::App& mdi = *app.add_subcommand("mdi", "Execute lines of G-code, one after the other");
  const auto lines = std::make_shared<std::vector<std::string>>();
  mdi.add_option("lines", *lines, "Each line as one argument, in quotes")
      ->type_name("LINE")
      ->required();
  mdi.callback([&task, lines] {
    task.when_interrupted = "the machine stops; lines after this one are not executed";
    task.action = [lines](const Context& context) {
      return done(while_asking(context, [&] { return execute_lines(context, *lines); }));
    };
  });
}

void add_sub(CLI::App& app, Task& task) {
  CLI::App& sub = *app.add_subcommand(
      "sub", "Run a sub of the macro files (user_1, zero_z) and wait for its end");
  const auto name = std::make_shared<std::string>();
  sub.add_option("name", *name, "As in macro.cnc or user_macro.cnc")->type_name("NAME")->required();
  sub.callback([&task, name] {
    task.when_interrupted = "the machine stops";
    task.action = [name](const Context& context) {
      return done(while_asking(context,
                               [&] { return context.client.run_sub(*name, context.interrupted); }));
    };
  });
}

struct JogArguments {
  std::string axis;
  std::optional<double> distance;
  std::optional<double> seconds;
  double rate_percent = 50.0;
};

Action make_jog_step(const JogArguments& arguments) {
  const api::Axis axis = parse_axis(arguments.axis);
  return [axis, arguments](const Context& context) {
    return done(
        context.client.jog_step(axis, *arguments.distance, arguments.rate_percent * kPercent));
  };
}

/// "X+" or "X-" for some seconds; Ctrl-C releases the key.
Action make_jog_held(const JogArguments& arguments) {
  const std::string_view word = arguments.axis;
  const char direction = word.size() == 2 ? word[1] : ' ';
  if (direction != '+' && direction != '-') {
    throw CLI::ValidationError("jog --for needs an axis with its direction, for example X+");
  }
  const double sign = direction == '+' ? 1.0 : -1.0;
  const api::JogVelocity velocity{parse_axis(word.substr(0, 1)),
                                  sign * arguments.rate_percent * kPercent};
  return [velocity, seconds = *arguments.seconds](const Context& context) -> api::Result<ExitCode> {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    api::JogSession session = context.client.jog();
    const auto result = session.while_held({velocity}, [&] {
      return std::chrono::steady_clock::now() < end && !context.interrupted.stop_requested();
    });
    if (result && context.interrupted.stop_requested()) return ExitCode::interrupted;
    return done(result);
  };
}

void add_jog(CLI::App& app, Task& task) {
  CLI::App& jog =
      *app.add_subcommand("jog", "Move by a distance (jog X -5), or for a time (jog X+ --for 2)");
  const auto arguments = std::make_shared<JogArguments>();
  jog.add_option("axis", arguments->axis, "X … C; with + or - for --for")->required();
  jog.add_option("distance", arguments->distance, "mm or degrees, signed");
  jog.add_option("--for", arguments->seconds, "Seconds to move")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, 3600.0));
  jog.add_option("--rate", arguments->rate_percent, "Percent of the axis' maximum velocity")
      ->type_name("PERCENT")
      ->check(CLI::Range(0.1, 100.0));
  jog.callback([&task, arguments] {
    if (arguments->distance.has_value() == arguments->seconds.has_value()) {
      throw CLI::ValidationError("jog needs either a distance or --for");
    }
    task.when_interrupted = "the machine stops";
    task.action = arguments->distance ? make_jog_step(*arguments) : make_jog_held(*arguments);
  });
}

/// Without options it only shows.
api::Result<api::Overrides> change_overrides(const api::Client& client,
                                             const api::OverrideChange& change) {
  if (change.feed || change.rapid || change.speed) return client.set_overrides(change);
  const auto status = client.status();
  if (!status) return std::unexpected(status.error());
  return api::Overrides{status->feed_override, status->rapid_override, status->speed_override};
}

struct OverrideOption {
  const char* name;
  const char* description;
  double max_percent;
  std::optional<double> api::OverrideChange::*member;
};
constexpr OverrideOption kOverrideOptions[]{
    {"--feed", "Feed, 0 to 300 percent", 300.0, &api::OverrideChange::feed},
    {"--rapid", "Rapid motion, 0 to 100 percent", 100.0, &api::OverrideChange::rapid},
    {"--speed", "Spindle speed, 0 to 300 percent", 300.0, &api::OverrideChange::speed},
};

void add_override(CLI::App& app, Task& task) {
  CLI::App& command = *app.add_subcommand("override", "Show or set overrides");
  const auto change = std::make_shared<api::OverrideChange>();
  for (const OverrideOption& option : kOverrideOptions) {
    command
        .add_option_function<double>(
            option.name,
            [change, &option](const double& percent) {
              (*change).*(option.member) = percent * kPercent;
            },
            option.description)
        ->type_name("PERCENT")
        ->check(CLI::Range(0.0, option.max_percent));
  }
  command.callback([&task, change] {
    task.action = [change](const Context& context) -> api::Result<ExitCode> {
      const auto overrides = change_overrides(context.client, *change);
      if (!overrides) return std::unexpected(overrides.error());
      fmt::print("{}\n",
                 context.options.json ? to_json(*overrides).dump() : format_overrides(*overrides));
      return ExitCode::ok;
    };
  });
}

void add_zero(CLI::App& app, Task& task) {
  CLI::App& zero = *app.add_subcommand(
      "zero", "Make the present position these work coordinates (zero X Y Z=2.5)");
  const auto words = std::make_shared<std::vector<std::string>>();
  zero.add_option("coordinates", *words, "X is X=0")->type_name("AXIS[=VALUE]")->required();
  zero.callback([&task, words] {
    std::vector<api::WorkCoordinate> coordinates;
    for (const std::string& word : *words) coordinates.push_back(parse_coordinate(word));
    task.action = [coordinates](const Context& context) {
      return done(context.client.set_work_zero(coordinates));
    };
  });
}

void add_estop(CLI::App& app, Task& task) {
  CLI::App& estop =
      *app.add_subcommand("estop", "The virtual board's estop button")->require_subcommand(1);
  const auto add = [&](const char* name, const char* description, bool pressed) {
    estop.add_subcommand(name, description)->callback([&task, pressed] {
      task.action = [pressed](const Context& context) {
        return done(context.client.simulate_estop(pressed));
      };
    });
  };
  add("press", "Press it", true);
  add("release", "Release it; reset acknowledges", false);
}

}  // namespace

void add_machine_commands(CLI::App& app, Task& task) {
  app.add_subcommand("reset", "Switch the drives on, acknowledge estop and errors")
      ->callback([&task] {
        task.action = [](const Context& context) { return done(context.client.reset()); };
      });
  add_home(app, task);
  add_accept(app, task);
  add_jog(app, task);
  add_mdi(app, task);
  add_sub(app, task);
  add_override(app, task);
  add_zero(app, task);
  add_estop(app, task);
}

}  // namespace cnc::ctl
