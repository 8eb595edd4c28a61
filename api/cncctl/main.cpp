// cncctl: the machine from a shell.
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <span>
#include <string_view>

#include "api/cncctl/command_line.h"
#include "api/cncctl/interrupt.h"
#include "api/cncctl/report.h"

namespace cnc::ctl {
namespace {

api::ClientOptions client_options(const GlobalOptions& options) {
  const auto timeout = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::duration<double>(options.timeout));
  api::ClientOptions result;
  result.connect_timeout = std::min(result.connect_timeout, timeout);
  result.call_timeout = timeout;
  return result;
}

api::Result<ExitCode> execute(const Task& task, const Interrupt& interrupt) {
  const api::ClientOptions options = client_options(task.options);
  if (!task.needs_server) {
    const auto client = api::Client::without_connecting(task.options.address, options);
    return task.action({task.options, client, interrupt.token()});
  }
  const auto client = api::Client::connect(task.options.address, options);
  if (!client) return std::unexpected(client.error());
  return task.action({task.options, *client, interrupt.token()});
}

ExitCode run(const Task& task) {
  const Interrupt interrupt;
  const auto result = execute(task, interrupt);
  const bool was_interrupted = interrupt.token().stop_requested() &&
                               (result ? *result == ExitCode::interrupted
                                       : result.error().kind == api::ErrorKind::cancelled);
  if (was_interrupted) {
    if (!task.when_interrupted.empty()) note("interrupted: " + task.when_interrupted);
    return ExitCode::interrupted;
  }
  if (result) return *result;
  report(result.error(), task.options.json);
  return exit_code_of(result.error().kind);
}

int run_command_line(int argc, char** argv) {
  Task task;
  const auto app = make_command_line(task);
  try {
    app->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // --help arrives here as well, with exit code 0.
    if (error.get_exit_code() == 0) return app->exit(error);
    const std::span arguments(argv, static_cast<std::size_t>(argc));
    const bool json = std::ranges::find(arguments, std::string_view("--json")) != arguments.end();
    report(usage_error(error.what()), json);
    return static_cast<int>(ExitCode::usage);
  }
  return static_cast<int>(run(task));
}

}  // namespace
}  // namespace cnc::ctl

int main(int argc, char** argv) { return cnc::ctl::run_command_line(argc, argv); }
