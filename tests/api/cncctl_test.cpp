// cncctl from outside: what it sends, prints and answers to the shell.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <string>
#include <vector>

#include "tests/api/cncctl_fixture.h"

namespace cnc::test {
namespace {

using Catch::Contains;
using Catch::StartsWith;

using Fixture = CtlFixture;

TEST_CASE("cncctl without a command is wrong usage, told on stderr", "[api][cncctl]") {
  const Outcome outcome = run_alone({});
  CHECK(outcome.exit_code == kUsage);
  CHECK(outcome.out.empty());
  CHECK_THAT(outcome.err, StartsWith("cncctl: ") && Contains("cncctl --help"));
}

TEST_CASE("cncctl --help shows every exit code", "[api][cncctl]") {
  const Outcome outcome = run_alone({"--help"});
  CHECK(outcome.exit_code == kOk);
  CHECK_THAT(outcome.out, Contains("0 done") && Contains("1 the machine refused") &&
                              Contains("2 wrong usage") && Contains("3 no server") &&
                              Contains("4 server of another API version") &&
                              Contains("130 interrupted"));
}

TEST_CASE("cncctl finds mistakes in its arguments before it asks a server", "[api][cncctl]") {
  const auto arguments = GENERATE(values<std::vector<std::string>>({
      {"home", "Q"},
      {"jog", "X"},
      {"jog", "X", "1", "--for", "2"},
      {"jog", "X", "--for", "2"},
      {"jog", "X", "far"},
      {"override", "--feed", "301"},
      {"override", "--rapid", "101"},
      {"zero"},
      {"zero", "X=much"},
      {"estop"},
      {"mdi"},
      {"sub"},
      {"answer", "deep"},
      {"answer", "Depth=deep"},
      {"answer", "5", "Depth=5"},
      {"answer", "--cancel", "5"},
      {"fly"},
  }));
  const Outcome outcome = run_alone(arguments);
  CAPTURE(arguments);
  CHECK(outcome.exit_code == kUsage);
  CHECK_THAT(outcome.err, StartsWith("cncctl: "));
}

TEST_CASE("cncctl without a server has its own exit code", "[api][cncctl]") {
  const TemporaryFolder folder;
  const Outcome text = run_alone({"--server", folder.socket(), "status"});
  CHECK(text.exit_code == kNoServer);
  CHECK_THAT(text.err, Contains(folder.socket()) && Contains("[E6001] — Whether cncserver runs"));
  const Outcome json = run_alone({"--server", folder.socket(), "status", "--json"});
  CHECK(json.exit_code == kNoServer);
  CHECK(nlohmann::json::parse(json.err).at("error").at("code") == 6001);
}

TEST_CASE("cncctl with a server of another version has its own exit code", "[api][cncctl][ARC-3]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.api_major = 2; });
  CHECK(f.run({"status"}).exit_code == kIncompatible);
  const Outcome version = f.run({"version"});
  CHECK(version.exit_code == kIncompatible);
  CHECK_THAT(version.out, Contains("API 1.0") && Contains("cncserver 9.8.7, API 2.4"));
}

TEST_CASE("A refusal is one line with the sentence and the advice", "[api][cncctl]") {
  Fixture f;
  refuse(f, "Home");
  const Outcome text = f.run({"home"});
  CHECK(text.exit_code == kRefused);
  CHECK(text.err == "cncctl: The drives are off. [E5001] — cncctl reset.\n");
  const Outcome json = f.run({"home", "--json"});
  const auto error = nlohmann::json::parse(json.err).at("error");
  CHECK(error.at("kind") == "refused");
  CHECK(error.at("name") == "command_not_allowed");
}

TEST_CASE("Commands of cncctl arrive at the server", "[api][cncctl]") {
  const auto [arguments, call] = GENERATE(table<std::vector<std::string>, std::string>({
      {{"reset"}, "Reset"},
      {{"home", "z", "X"}, "Home AXIS_Z AXIS_X "},
      {{"jog", "X", "-5"}, "Step AXIS_X -5 0.5"},
      {{"jog", "y", "-.5", "--rate", "10"}, "Step AXIS_Y -0.5 0.1"},
      {{"mdi", "G0 X1", "G0 X-2"}, "Execute G0 X-2"},
      {{"override", "--feed", "150"}, "SetOverrides feed=1.5 "},
      {{"accept"}, "AcceptPosition"},
      {{"accept", "z", "X"}, "AcceptPosition AXIS_Z AXIS_X "},
      {{"zero", "X", "Z=-2.5"}, "SetWorkZero AXIS_X=0 AXIS_Z=-2.5 "},
      {{"estop", "press"}, "SimulateEstop pressed"},
      {{"estop", "release"}, "SimulateEstop released"},
      {{"run"}, "Run"},
      {{"pause"}, "Pause"},
      {{"resume"}, "Resume"},
      {{"stop"}, "Stop"},
      {{"rewind"}, "Rewind"},
      {{"sub", "user_3"}, "RunSub user_3"},
  }));
  Fixture f;
  const Outcome outcome = f.run(arguments);
  CAPTURE(arguments, outcome.err);
  CHECK(outcome.exit_code == kOk);
  CHECK(f.machine.has_seen(call));
}

TEST_CASE("cncctl mdi ends at the first line that fails", "[api][cncctl]") {
  Fixture f;
  refuse(f, "Execute");
  CHECK(f.run({"mdi", "G0 X1", "G0 X2"}).exit_code == kRefused);
  CHECK(f.machine.has_seen("Execute G0 X1"));
  CHECK_FALSE(f.machine.has_seen("Execute G0 X2"));
}

TEST_CASE("cncctl jog --for moves and stops", "[api][cncctl]") {
  Fixture f;
  CHECK(f.run({"jog", "X-", "--for", "0.2", "--rate", "30"}).exit_code == kOk);
  const std::lock_guard lock(f.machine.mutex);
  REQUIRE(f.machine.jog_rates.size() >= 2);
  CHECK(f.machine.jog_rates.front().at(v1::AXIS_X) == Approx(-0.3));
  CHECK(f.machine.jog_rates.back() == std::vector<double>(7, 0.0));
  CHECK(f.machine.leases_run_out == 0);
}

TEST_CASE("A relative path becomes absolute for a server on this computer", "[api][cncctl]") {
  Fixture f;
  const std::string expected = (std::filesystem::current_path() / "jobs/a.nc").string();
  const Outcome outcome = f.run({"load", "./jobs/a.nc"});
  CHECK(outcome.exit_code == kOk);
  CHECK(outcome.out == expected + ": 12 lines, 345 bytes\n");

  FakeMachine far_machine;
  const FakeServer far(far_machine, "127.0.0.1:0");
  CHECK(run_alone({"--server", far.address(), "load", "jobs/a.nc"}).exit_code == kOk);
  CHECK(far_machine.has_seen("Load jobs/a.nc"));
}

TEST_CASE("cncctl status shows positions in mm with four decimals", "[api][cncctl]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) {
    m.status.set_state(v1::MACHINE_STATE_READY);
    m.status.set_state_text("Ready.");
    m.status.mutable_work_position()->set_x(12.34567);
    m.status.set_feed(10.0);
  });
  const Outcome text = f.run({"status"});
  CHECK(text.exit_code == kOk);
  CHECK_THAT(text.out, Contains("ready - Ready.") && Contains("12.3457") &&
                           Contains("600.0 mm/min"));  // 10 mm/s
  const auto json = nlohmann::json::parse(f.run({"status", "--json"}).out);
  CHECK(json.at("state") == "ready");
  CHECK(json.at("work_position").at("x") == 12.3457);
  CHECK(json.at("feed") == 10.0);
  CHECK(json.at("commands").at("run").at("allowed") == false);
}

TEST_CASE("cncctl status --watch goes on until Ctrl-C", "[api][cncctl]") {
  Fixture f;
  Process process = f.start({"status", "--watch", "--json"});
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.status.sequence() >= 3; }));
  process.signal(SIGINT);
  const Outcome outcome = process.wait();
  CHECK(outcome.exit_code == kInterrupted);
  CHECK(nlohmann::json::parse(outcome.out.substr(0, outcome.out.find('\n'))).at("sequence") == 1);
}

TEST_CASE("cncctl override without options shows what holds", "[api][cncctl][MAN-8]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) {
    m.status.set_feed_override(1.2);
    m.status.set_rapid_override(0.5);
    m.status.set_speed_override(1.0);
  });
  CHECK(f.run({"override"}).out == "feed 120 %, rapid 50 %, speed 100 %\n");
}

TEST_CASE("cncctl lists problems, messages and the link's health", "[api][cncctl]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) {
    v1::Problem& problem = m.problems.emplace_back();
    *problem.mutable_error() = error_detail(2007, "arc_radius", "R is too small.", "The word R.");
    problem.mutable_error()->mutable_place()->set_file("a.nc");
    problem.mutable_error()->mutable_place()->set_line(17);
    problem.set_line_text("G2 X1 R0.1");
    v1::CallSite& call = *problem.add_calls();
    call.set_sub("pocket");
    call.mutable_place()->set_file("part.nc");
    call.mutable_place()->set_line(3);
    v1::Message& message = m.messages.emplace_back();
    message.set_sequence(1);
    message.set_severity(v1::SEVERITY_WARNING);
    message.set_text("Tool 3 is worn.");
  });
  CHECK_THAT(f.run({"problems"}).out,
             Contains("a.nc:17: R is too small. [E2007]") && Contains("G2 X1 R0.1") &&
                 Contains("in sub pocket, called at part.nc:3") && Contains("1 problems"));
  const auto problems = nlohmann::json::parse(f.run({"problems", "--json"}).out).at("problems");
  CHECK(problems.at(0).at("calls").at(0).at("place").at("line") == 3);
  CHECK_THAT(f.run({"messages"}).out, Contains("warning Tool 3 is worn."));
  CHECK(nlohmann::json::parse(f.run({"messages", "--json"}).out).at("severity") == "warning");
  CHECK_THAT(f.run({"link"}).out, Contains("1000 of 1.000 ms") && Contains("250 us"));
}

TEST_CASE("cncctl link shows the board, its packets and a bar for each bin",
          "[api][cncctl][LNK-2]") {
  Fixture f;
  const std::string text = f.run({"link"}).out;
  CHECK_THAT(text, Contains("board        a fake board, serial number 77, connected\n") &&
                       Contains("sessions     2\n") && Contains("FIFO         has not moved\n") &&
                       Contains("300 us the last, 400 us the mean, 12 ms at most\n") &&
                       Contains("2000 sent, 3 of them again\n") &&
                       Contains("1990 taken, 4 passed over, 5 corrupted\n"));
  CHECK_THAT(text,
             Contains("latch        home switch at Y-2.500, 61.5 s ago\n") &&
                 Contains("latch        emergency stop at X10.250 Y0.000 Z-4.000, 250 ms ago, "
                          "the 3. since power-up\n"));
  // A quarter and three quarters of 40 cells; an empty bin between them has no bar.
  const auto cells = [](int count) {
    std::string bar;
    for (int i = 0; i < count; ++i) bar += "█";
    return bar;
  };
  CHECK_THAT(text, Contains("< 100 ms           1   25.00 %  " + cells(10) + "\n") &&
                       Contains("< 125 ms           0    0.00 %\n") &&
                       Contains("< 150 ms           3   75.00 %  " + cells(30) + "\n"));
  CHECK_THAT(text, !Contains("work of cycles"));  // nothing recorded

  const auto json = nlohmann::json::parse(f.run({"link", "--json"}).out);
  CHECK(json.at("lateness")[0].at("upper").is_null());
  CHECK(json.at("fifo_time")[2].at("count") == 3);
  CHECK(json.at("packets").at("passed_over") == 4);
  CHECK(json.at("board_serial") == 77);
  CHECK(json.at("latches")[0].at("position") == nlohmann::json{{"y", -2.5}});
  CHECK(json.at("latches")[1].at("source") == "estop");
  CHECK(json.at("latches")[1].at("position").at("x") == 10.25);
}

TEST_CASE("cncctl link trace prints where the trace is, or why there is none", "[api][cncctl]") {
  Fixture f;
  CHECK(f.run({"link", "trace"}).out == "/data/traces/now.trace\n");
  CHECK(nlohmann::json::parse(f.run({"link", "trace", "--json"}).out).at("path") ==
        "/data/traces/now.trace");
  CHECK_FALSE(f.machine.saw("GetLinkStatistics"));
  CHECK_THAT(f.run({"link", "--help"}).out, Contains("trace") && Contains("--watch"));
  CHECK_THAT(f.run({"completion", "bash"}).out, Contains("trace"));
  refuse(f, "SaveLinkTrace");
  CHECK(f.run({"link", "trace"}).exit_code == kRefused);
}

TEST_CASE("cncctl link --watch goes on until Ctrl-C and resets once", "[api][cncctl]") {
  Fixture f;
  Process process = f.start({"link", "--watch", "--reset", "--json"});
  REQUIRE(f.machine.becomes([](FakeMachine& m) {
    return std::ranges::count(m.calls, "GetLinkStatistics reset") == 1 &&
           std::ranges::count_if(m.calls, [](const std::string& call) {
             return call.starts_with("GetLinkStatistics");
           }) >= 2;
  }));
  process.signal(SIGINT);
  CHECK(process.wait().exit_code == kInterrupted);
}

TEST_CASE("Ctrl-C during homing stops the machine and says so", "[api][cncctl][safety]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.hold_motion = true; });
  Process process = f.start({"home"});
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.saw("Home"); }));
  process.signal(SIGINT);
  const Outcome outcome = process.wait();
  CHECK(outcome.exit_code == kInterrupted);
  CHECK_THAT(outcome.err, Contains("the machine stops"));
  CHECK(f.machine.becomes([](FakeMachine& m) { return m.cancelled_calls == 1; }));
}

TEST_CASE("run --wait ends well with the job and tells both times", "[api][cncctl]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.when_run = start_job; });
  Process process = f.start({"run", "--progress"});
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.status.sequence() >= 2; }));
  f.machine.change([](FakeMachine& m) { end_job(m, true); });
  const Outcome outcome = process.wait();
  CHECK(outcome.exit_code == kOk);
  // 61 s left and 5 of 10 lines while it ran; 123 s it took, 122 s were predicted.
  CHECK_THAT(outcome.out,
             Contains("50 % line 5/10 1:01 left") && Contains("job time 2:03, predicted 2:02"));
}

TEST_CASE("run --go-on answers a tool change but not a pause", "[api][cncctl]") {
  Fixture f;
  const auto [state, is_answered] = GENERATE(table<v1::MachineState, bool>(
      {{v1::MACHINE_STATE_TOOL_CHANGE, true}, {v1::MACHINE_STATE_PAUSED, false}}));
  f.machine.change([state = state](FakeMachine& m) {
    m.when_run = [state](FakeMachine& machine) {
      start_job(machine);
      machine.status.set_state(state);
    };
  });
  Process process = f.start({"run", "--go-on"});
  // cncctl has seen the prompt when it has answered it, or, a pause, when some statuses were sent.
  REQUIRE(f.machine.becomes([is_answered = is_answered](FakeMachine& m) {
    return is_answered ? m.saw("Resume") : m.status.sequence() >= 5;
  }));
  CHECK(f.machine.has_seen("Resume") == is_answered);
  f.machine.change([](FakeMachine& m) { end_job(m, true); });
  CHECK(process.wait().exit_code == kOk);
}

TEST_CASE("run --wait of a job that fails answers the machine's error", "[api][cncctl]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.when_run = start_job; });
  Process process = f.start({"run", "--wait"});
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.status.sequence() >= 2; }));
  f.machine.change([](FakeMachine& m) {
    end_job(m, false);
    v1::Message& message = m.messages.emplace_back();
    message.set_sequence(1);
    message.set_severity(v1::SEVERITY_ERROR);
    *message.mutable_error() = error_detail(2007, "arc_radius", "R is too small.", "The word R.");
  });
  const Outcome outcome = process.wait();
  CHECK(outcome.exit_code == kRefused);
  CHECK_THAT(outcome.err, Contains("R is too small. [E2007] — The word R."));
}

TEST_CASE("run --wait without its server ends; the job is the server's", "[api][cncctl]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  machine.when_run = start_job;
  auto server = std::make_unique<FakeServer>(machine, folder.socket());
  Process process({CNCCTL, "--server", folder.socket(), "run", "--wait"},
                  folder.file("cncctl").string());
  REQUIRE(machine.becomes([](FakeMachine& m) { return m.status.sequence() >= 2; }));
  server.reset();
  CHECK(process.wait().exit_code == kNoServer);
}

TEST_CASE("Ctrl-C during run --wait leaves the job running and says so", "[api][cncctl]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.when_run = start_job; });
  Process process = f.start({"run", "--wait"});
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.status.sequence() >= 2; }));
  process.signal(SIGINT);
  const Outcome outcome = process.wait();
  CHECK(outcome.exit_code == kInterrupted);
  CHECK_THAT(outcome.err, Contains("the job goes on"));
  CHECK_FALSE(f.machine.has_seen("Stop"));
}

/// The words under "Subcommands:" in the help.
std::vector<std::string> commands_in_help() {
  std::vector<std::string> names;
  std::istringstream help(run_alone({"--help"}).out);
  std::string line;
  bool is_list = false;
  while (std::getline(help, line)) {
    if (is_list && line.empty()) break;
    if (is_list) names.push_back(line.substr(2, line.find(' ', 2) - 2));
    if (line == "Subcommands:") is_list = true;
  }
  return names;
}

TEST_CASE("Completion scripts mention every command and compile", "[api][cncctl]") {
  const std::vector<std::string> commands = commands_in_help();
  REQUIRE(commands.size() >= 21);
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    const Outcome outcome = run_alone({"completion", shell});
    CHECK(outcome.exit_code == kOk);
    for (const std::string& command : commands) CHECK_THAT(outcome.out, Contains(command));
    CHECK_THAT(outcome.out, Contains("rapid"));
  }
}

TEST_CASE("Bash completes commands, their options and the words below them", "[api][cncctl]") {
  const TemporaryFolder folder;
  const Outcome script = run_alone({"completion", "bash"});
  const std::string path = folder.file("completion").string();
  const auto completed = [&](const std::string& words, int index) {
    std::ofstream(path) << script.out << "COMP_WORDS=(" << words << "); COMP_CWORD=" << index
                        << "; _cncctl; echo \"${COMPREPLY[*]}\"\n";
    return Process({"/bin/bash", path}, folder.file("bash").string()).wait().out;
  };
  CHECK(completed("cncctl re", 1) == "reset resume rewind\n");
  CHECK(completed("cncctl override --r", 2) == "--rapid\n");
  CHECK(completed("cncctl estop ''", 2) == "press release --help --server --timeout --json\n");
}

TEST_CASE("The exit codes in docs/cncctl.md are those of the help", "[api][cncctl]") {
  std::ifstream file(std::string(CNC_SOURCE_DIR) + "/docs/cncctl.md");
  REQUIRE(file.good());
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const int code : {kOk, kRefused, kUsage, kNoServer, kIncompatible, kInterrupted}) {
    CHECK_THAT(text, Contains("| " + std::to_string(code) + " |"));
  }
  for (const std::string& command : commands_in_help()) {
    CHECK_THAT(text, Contains("`cncctl " + command));
  }
}

}  // namespace
}  // namespace cnc::test
