// Commands that only look: status, problems, messages, version.
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <mutex>
#include <unistd.h>
#include <vector>

#include "api/cncctl/command_line.h"
#include "api/cncctl/interrupt.h"
#include "api/cncctl/json.h"
#include "api/cncctl/report.h"
#include "api/cncctl/text.h"

namespace cnc::ctl {
namespace {

template <typename T>
void print_json(const T& value) {
  fmt::print("{}\n", to_json(value).dump());
  std::fflush(stdout);
}

void note_connection(const api::ConnectionChange& change, bool json) {
  if (change.reason) report(*change.reason, json);
}

api::Result<ExitCode> show_status(const Context& context) {
  const auto status = context.client.status();
  if (!status) return std::unexpected(status.error());
  if (context.options.json) {
    print_json(*status);
    return ExitCode::ok;
  }
  const auto machine = context.client.machine();
  if (!machine) return std::unexpected(machine.error());
  fmt::print("{}", format_status(*status, axes_of(*machine)));
  return ExitCode::ok;
}

/// Until Ctrl-C; survives restarts of the server. On a terminal one line is written over and over.
api::Result<ExitCode> watch_status(const Context& context) {
  const auto machine = context.client.machine();
  if (!machine) return std::unexpected(machine.error());
  const bool json = context.options.json;
  const bool in_place = !json && isatty(STDOUT_FILENO);
  const auto show = [json, in_place, axes = axes_of(*machine)](const api::MachineStatus& status) {
    if (json) return print_json(status);
    const std::string line = format_status_line(status, axes);
    fmt::print("{}", in_place ? "\r\x1b[K" + line : line + '\n');
    std::fflush(stdout);
  };
  const auto subscription = context.client.subscribe_status(
      {.max_rate = 10.0}, show,
      [json](const api::ConnectionChange& change) { note_connection(change, json); });
  wait_for(context.interrupted);
  return ExitCode::interrupted;
}

api::Result<ExitCode> show_problems(const Context& context) {
  const auto list = context.client.problems();
  if (!list) return std::unexpected(list.error());
  if (context.options.json) {
    print_json(*list);
    return ExitCode::ok;
  }
  for (const api::Problem& problem : list->problems) fmt::print("{}", format_problem(problem));
  fmt::print("{} problems{}\n", list->problems.size(),
             list->complete ? "" : " so far; the check still runs");
  return ExitCode::ok;
}

void print_message(const api::Message& message, bool json) {
  if (json) return print_json(message);
  fmt::print("{}", format_message(message));
  std::fflush(stdout);
}

api::Result<ExitCode> show_messages(const Context& context) {
  const auto messages = context.client.messages();
  if (!messages) return std::unexpected(messages.error());
  for (const api::Message& message : *messages) print_message(message, context.options.json);
  return ExitCode::ok;
}

api::Result<ExitCode> follow_messages(const Context& context) {
  const bool json = context.options.json;
  const auto subscription = context.client.subscribe_messages(
      0, [json](const api::Message& message) { print_message(message, json); },
      [json](const api::ConnectionChange& change) { note_connection(change, json); });
  wait_for(context.interrupted);
  return ExitCode::interrupted;
}

/// Shows both versions even if they do not fit together, for then they are what is wanted.
api::Result<ExitCode> show_version(const Context& context) {
  if (!context.options.json) {
    fmt::print("cncctl {}, API {}.{}\n", CNCCTL_VERSION, api::kApiMajor, api::kApiMinor);
  }
  const auto version = context.client.version();
  if (!version) return std::unexpected(version.error());
  if (context.options.json) {
    const nlohmann::json own{
        {"client", CNCCTL_VERSION}, {"api_major", api::kApiMajor}, {"api_minor", api::kApiMinor}};
    fmt::print("{}\n", nlohmann::json{{"cncctl", own}, {"server", to_json(*version)}}.dump());
  } else {
    fmt::print("cncserver {}, API {}.{}, {}\n", version->server, version->api_major,
               version->api_minor, version->controller);
  }
  return version->api_major == api::kApiMajor ? ExitCode::ok : ExitCode::incompatible;
}

}  // namespace

void add_info_commands(CLI::App& app, Task& task) {
  CLI::App& status = *app.add_subcommand("status", "Show state, positions and job");
  const auto watch = std::make_shared<bool>(false);
  status.add_flag("--watch", *watch, "Until Ctrl-C, one line per status");
  status.callback([&task, watch] { task.action = *watch ? watch_status : show_status; });

  app.add_subcommand("problems", "List what the check of the loaded program found")
      ->callback([&task] { task.action = show_problems; });

  CLI::App& messages = *app.add_subcommand("messages", "List what the machine had to say");
  const auto follow = std::make_shared<bool>(false);
  messages.add_flag("--follow", *follow, "Until Ctrl-C, new ones as they come");
  messages.callback([&task, follow] { task.action = *follow ? follow_messages : show_messages; });

  app.add_subcommand("version", "Show the versions of cncctl and of the server")->callback([&task] {
    task.needs_server = false;
    task.action = show_version;
  });
}

}  // namespace cnc::ctl
