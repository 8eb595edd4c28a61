// cncsim: runs and checks programs on a simulated machine, and replays traces, in virtual time.
#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "server/cncsim/options.h"
#include "server/version.h"

namespace {

void add_common(CLI::App& command, cnc::server::SimInput& input) {
  command.add_option("file", input.file, "G-code program")->required();
  command.add_option("--config", input.config,
                     "Machine configuration; default: the shipped cnc.ini");
  command.add_option(
      "--parameters", input.parameters,
      "Parameter file with work offsets; default: the shipped one (G54 at 100 100 -90)");
  command.add_option("--tools", input.tools, "Tool table; default: the shipped one");
  command.add_option("--macros", input.macros,
                     "Macro files, the system's first; default: the shipped macro.cnc");
  command.add_option("--set", input.settings,
                     "Overrides a setting: SECTION.key=value; may be repeated");
  command.add_flag("--json", input.json, "Report as JSON");
}

}  // namespace

int main(int argc, char** argv) {
  using namespace cnc::server;
  spdlog::set_level(spdlog::level::off);

  CLI::App app{"cncsim: runs and checks G-code programs on a simulated machine, in virtual time."};
  app.set_version_flag("--version", kServerVersion);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 good; 1 the program has errors or the machine stopped; 2 wrong usage or "
      "unreadable input.");

  RunOptions run_options;
  CLI::App* run = app.add_subcommand(
      "run", "Runs a program through interpreter, planner, segments, board and machine");
  run->footer(
      "The machine starts homed at machine zero. Prompts (M0, M6) are answered \"go on\", "
      "questions (dlgmsg) \"OK\" with the values that they propose.");
  add_common(*run, run_options);
  run->add_option("--record", run_options.record,
                  "CSV of the commanded trajectory, one row per millisecond: t,x,y,z,a,b,c,f,line "
                  "(s, mm or deg in machine coordinates, feed limit in mm/s with 0 for a rapid, "
                  "source line)");
  run->add_option("--scenario", run_options.scenario,
                  "How the virtual machine is built and what happens to it, docs/scenarios.md");

  run->add_option("--trace", run_options.trace,
                  "File of the last 30 s of the link to the board, for cncsim replay");

  CheckOptions check_options;
  CLI::App* check = app.add_subcommand("check", "Interprets a program and lists every error");
  add_common(*check, check_options);
  check->add_option("--canon", check_options.canon,
                    "Text file of the canonical commands, machine coordinates in mm");
  check->add_option("--max-errors", check_options.max_errors, "Stop after so many errors")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  check
      ->add_option("--max-loop-lines", check_options.max_loop_lines,
                   "Give up after so many lines in loops and subs without coming to a new line; "
                   "0: never")
      ->capture_default_str();
  check->add_flag("--progress", check_options.progress,
                  "Show how far it has come, as on a terminal");
  check->footer("Ctrl-C ends the check with the report of what it has read.");

  ReplayOptions replay_options;
  CLI::App* replay =
      app.add_subcommand("replay", "Shows a trace of the link and replays it on a virtual board");
  replay
      ->add_option("file", replay_options.file,
                   "Trace: a file of the folder traces/ of a server's data, or of cncctl link "
                   "trace")
      ->required();
  replay
      ->add_option("--last", replay_options.last,
                   "Lists the exchanges of so many seconds at the end")
      ->check(CLI::Range(0.0, 3600.0));
  replay->add_option("--csv", replay_options.csv, "CSV of every field of every exchange");
  replay->add_flag("--json", replay_options.json, "Report as JSON");
  replay->footer(
      "Exit code 0: the virtual board does what was recorded, faults included; 1: it does not, or "
      "nothing could be replayed.");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (replay->parsed()) return replay_command(replay_options);
  return run->parsed() ? run_command(run_options) : check_command(check_options);
}
