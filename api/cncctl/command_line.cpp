#include "api/cncctl/command_line.h"

#include <fmt/format.h>

#include "api/cncctl/completion.h"

namespace cnc::ctl {
namespace {

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 the machine refused or the job failed; 2 wrong usage; 3 no server or\n"
    "connection lost; 4 server of another API version; 130 interrupted by Ctrl-C.\n"
    "Positions are millimetres and degrees. Errors go to stderr.";

void add_global_options(CLI::App& app, GlobalOptions& options) {
  app.add_option("--server", options.address,
                 "Where the server listens: unix:///path or host:port (else $CNC_SERVER, else the "
                 "user's socket)")
      ->type_name("ADDRESS");
  app.add_option("--timeout", options.timeout, "Seconds to wait for the answer to a call")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.1, 3600.0));
  app.add_flag("--json", options.json, "Results and errors as JSON");
}

void add_completion(CLI::App& app, Task& task) {
  CLI::App& completion = *app.add_subcommand("completion", "Print a completion script for a shell")
                              ->require_subcommand(1);
  for (const Shell& shell : shells()) {
    completion.add_subcommand(shell.name, shell.description)->callback([&app, &task, &shell] {
      task.needs_server = false;
      task.action = [&app, &shell](const Context&) -> api::Result<ExitCode> {
        fmt::print("{}", shell.script(app));
        return ExitCode::ok;
      };
    });
  }
}

}  // namespace

std::unique_ptr<CLI::App> make_command_line(Task& task) {
  auto app = std::make_unique<CLI::App>("Controls a CNC machine through its server.", "cncctl");
  app->require_subcommand(1);
  app->fallthrough();  // global options may stand behind the command
  app->footer(kFooter);
  add_global_options(*app, task.options);
  add_info_commands(*app, task);
  add_link_command(*app, task);
  add_machine_commands(*app, task);
  add_job_commands(*app, task);
  add_answer_command(*app, task);
  add_completion(*app, task);
  return app;
}

}  // namespace cnc::ctl
