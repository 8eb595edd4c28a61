// cncctl: the machine from a shell.
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

/// CLI11 takes "-5" for a number but "-.5" for an option, so a zero is put in.
std::string with_leading_zero(std::string_view argument) {
  const bool is_number =
      argument.size() > 2 && argument.starts_with("-.") && argument[2] >= '0' && argument[2] <= '9';
  return is_number ? "-0" + std::string(argument.substr(1)) : std::string(argument);
}

int run_command_line(std::span<char*> arguments) {
  Task task;
  const auto app = make_command_line(task);
  std::vector<std::string> words;
  for (const char* argument : arguments.subspan(1)) words.push_back(with_leading_zero(argument));
  const bool json = std::ranges::find(words, "--json") != words.end();
  std::ranges::reverse(words);  // CLI11 takes them from the end
  try {
    app->parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    // --help arrives here as well, with exit code 0.
    if (error.get_exit_code() == 0) return app->exit(error);
    report(usage_error(error.what()), json);
    return static_cast<int>(ExitCode::usage);
  }
  return static_cast<int>(run(task));
}

}  // namespace
}  // namespace cnc::ctl

int main(int argc, char** argv) {
  return cnc::ctl::run_command_line({argv, static_cast<std::size_t>(argc)});
}
