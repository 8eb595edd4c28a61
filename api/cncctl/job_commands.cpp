// Commands to the job: load, run, pause, resume, stop, rewind.
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>

#include "api/cncctl/command_line.h"
#include "api/cncctl/json.h"
#include "api/cncctl/run_progress.h"

namespace cnc::ctl {
namespace {

/// Paths are the server's. Where it shares our file system, a relative path means ours.
std::string path_for_server(const api::Client& client, const std::string& path) {
  return client.is_local() ? std::filesystem::absolute(path).lexically_normal().string() : path;
}

api::Result<ExitCode> load(const Context& context, const std::string& path) {
  const auto job = context.client.load(path_for_server(context.client, path));
  if (!job) return std::unexpected(job.error());
  if (context.options.json) {
    fmt::print("{}\n", to_json(*job).dump());
  } else {
    fmt::print("{}: {} lines, {} bytes\n", job->path, job->lines, job->bytes);
  }
  return ExitCode::ok;
}

void add_load(CLI::App& app, Task& task) {
  CLI::App& command = *app.add_subcommand("load", "Load a program and begin its check");
  const auto path = std::make_shared<std::string>();
  command.add_option("file", *path, "On the server's computer")->type_name("FILE")->required();
  command.callback([&task, path] {
    task.action = [path](const Context& context) { return load(context, *path); };
  });
}

void add_run(CLI::App& app, Task& task) {
  CLI::App& command = *app.add_subcommand("run", "Start the loaded program at its first line");
  const auto wait = std::make_shared<bool>(false);
  const auto options = std::make_shared<RunOptions>();
  command.add_flag("--wait", *wait, "Until the job has ended; exit code 1 if it did not end well");
  command.add_flag("--progress", options->show_progress, "Like --wait, and show the progress");
  command.add_flag(
      "--go-on", options->go_on,
      "Like --wait, resume after M0, M1 and tool changes, and say OK to questions: for "
      "simulated machines");
  command.callback([&task, wait, options] {
    if (!*wait && !options->show_progress && !options->go_on) {
      task.action = [](const Context& context) { return done(context.client.run()); };
      return;
    }
    task.when_interrupted = "the job goes on; 'cncctl stop' ends it";
    task.action = [options](const Context& context) { return run_and_wait(context, *options); };
  });
}

struct JobCommand {
  const char* name;
  const char* description;
  api::Result<void> (api::Client::*call)() const;
};
constexpr JobCommand kJobCommands[]{
    {"pause", "Slow down along the path and stand still", &api::Client::pause},
    {"resume", "Go on after a pause, M0, M1 or a tool change", &api::Client::resume},
    {"stop", "Slow down and end the job or the single line", &api::Client::stop},
    {"rewind", "Back to the first line", &api::Client::rewind},
};

}  // namespace

void add_job_commands(CLI::App& app, Task& task) {
  add_load(app, task);
  add_run(app, task);
  for (const JobCommand& command : kJobCommands) {
    app.add_subcommand(command.name, command.description)->callback([&task, &command] {
      task.action = [&command](const Context& context) {
        return done((context.client.*command.call)());
      };
    });
  }
}

}  // namespace cnc::ctl
