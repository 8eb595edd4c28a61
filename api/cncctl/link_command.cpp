// How the link to the board is: once, watched, or as a trace.
#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <unistd.h>

#include "api/cncctl/command_line.h"
#include "api/cncctl/interrupt.h"
#include "api/cncctl/json.h"
#include "api/cncctl/text.h"

namespace cnc::ctl {
namespace {

constexpr std::chrono::seconds kWatchPeriod{1};
constexpr const char* kClearScreen = "\x1b[H\x1b[2J";

struct LinkOptions {
  bool reset = false;
  bool watch = false;
};

api::Result<void> print_link(const Context& context, bool reset) {
  const auto statistics = context.client.link_statistics(reset);
  if (!statistics) return std::unexpected(statistics.error());
  if (context.options.json) {
    fmt::print("{}\n", to_json(*statistics).dump());
  } else {
    const auto machine = context.client.machine();
    if (!machine) return std::unexpected(machine.error());
    fmt::print("{}", format_link(*statistics, axes_of(*machine)));
  }
  std::fflush(stdout);
  return {};
}

/// Until Ctrl-C or the server's end. On a terminal one table is written over and over.
api::Result<ExitCode> watch_link(const Context& context, bool reset) {
  const bool in_place = !context.options.json && isatty(STDOUT_FILENO);
  do {
    if (in_place) fmt::print("{}", kClearScreen);
    if (auto printed = print_link(context, reset); !printed)
      return std::unexpected(printed.error());
    reset = false;  // counted anew from the first on
  } while (!wait_for(context.interrupted, kWatchPeriod));
  return ExitCode::interrupted;
}

api::Result<ExitCode> save_trace(const Context& context) {
  const auto path = context.client.save_link_trace();
  if (!path) return std::unexpected(path.error());
  if (context.options.json)
    fmt::print("{}\n", nlohmann::json{{"path", *path}}.dump());
  else
    fmt::print("{}\n", *path);
  return ExitCode::ok;
}

}  // namespace

void add_link_command(CLI::App& app, Task& task) {
  CLI::App& link = *app.add_subcommand("link", "Show how the link to the board has been");
  const auto options = std::make_shared<LinkOptions>();
  link.add_flag("--reset", options->reset, "Start counting anew afterwards");
  link.add_flag("--watch", options->watch, "Until Ctrl-C, once a second");
  CLI::App& trace = *link.add_subcommand(
      "trace", "Write the last 30 s of the link to a file for cncsim replay, and print its path");
  trace.callback([&task] { task.action = save_trace; });
  link.callback([&task, options, &trace] {
    if (trace.parsed()) return;
    task.action = [options](const Context& context) -> api::Result<ExitCode> {
      if (options->watch) return watch_link(context, options->reset);
      return done(print_link(context, options->reset));
    };
  });
}

}  // namespace cnc::ctl
