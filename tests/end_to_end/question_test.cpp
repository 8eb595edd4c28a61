// What programs ask, and the shipped macros, with the real server and the real cncctl (LNG-4,
// LNG-6).
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <thread>

#include "tests/end_to_end/test_server.h"

using namespace cnc;
using namespace cnc::api;
using namespace cnc::test;
using Catch::Contains;

namespace {

/// X goes where the operator says, or to 1 if he cancels.
constexpr const char* kAskingJob =
    "G53 G0 X0\n#100 = 5\n#101 = 2\ndlgmsg \"Where to?\" \"Place of X\" 100 \"Place of Y\" 101\n"
    "if [#5398 == 1]\nG53 G0 X#100 Y#101\nelse\nG53 G0 X1\nendif\nM30\n";

Process start_ctl(const ServerFolder& folder, std::vector<std::string> arguments,
                  const std::string& name) {
  arguments.insert(arguments.begin(), {CNCCTL, "--server", folder.address()});
  return {arguments, folder.file(name)};
}

Outcome ctl(const ServerFolder& folder, const std::vector<std::string>& arguments) {
  return start_ctl(folder, arguments, "cncctl").wait();
}

void wait_for_the_question(RunningServer& server) {
  REQUIRE(
      server.watcher.sees([](const MachineStatus& status) { return status.question.has_value(); }));
}

bool ended_at(RunningServer& server, double x, double y) {
  return server.watcher.sees([&](const MachineStatus& status) {
    return status.job.runs == 1 && status.job.ended_well &&
           status.machine_position[Axis::X] == Approx(x).margin(1e-6) &&
           status.machine_position[Axis::Y] == Approx(y).margin(1e-6);
  });
}

}  // namespace

TEST_CASE("A user key of the shipped macros runs", "[LNG-6][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  const Outcome outcome = ctl(folder, {"sub", "user_3"});
  INFO(outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(ctl(folder, {"messages"}).out, Contains("user_3 is free"));
  const Outcome unknown = ctl(folder, {"sub", "user_11"});
  CHECK(unknown.exit_code == 1);
  CHECK_THAT(unknown.err, Contains("There is no sub user_11"));
}

TEST_CASE("A job's question is shown and answered from a shell", "[LNG-4][e2e]") {
  const auto [words, x, y] = GENERATE(table<std::vector<std::string>, double, double>({
      {{"answer", "30", "20"}, 30.0, 20.0},
      {{"answer", "place of x=12.5"}, 12.5, 2.0},
      {{"answer"}, 5.0, 2.0},
  }));
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  server.start_job(kAskingJob);
  wait_for_the_question(server);
  CHECK(server.watcher.newest().state == MachineState::question);
  CHECK_THAT(ctl(folder, {"status"}).out, Contains("question Where to?") &&
                                              Contains("Place of X = 5") &&
                                              Contains("cncctl answer 5 2"));
  const Outcome outcome = ctl(folder, words);
  INFO(outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK(ended_at(server, x, y));
}

TEST_CASE("A cancelled question lets the program go on and see it", "[LNG-4][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  server.start_job(kAskingJob);
  wait_for_the_question(server);
  const double y = server.watcher.newest().machine_position[Axis::Y];
  CHECK(ctl(folder, {"answer", "--cancel"}).exit_code == 0);
  CHECK(ended_at(server, 1.0, y));
}

TEST_CASE("Of two answers the second is refused", "[LNG-4][ARC-2][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  const auto other = Client::connect(folder.address());
  REQUIRE(other);
  server.start_job("dlgmsg \"First?\"\ndlgmsg \"Second?\"\nM30\n");
  wait_for_the_question(server);
  const std::uint64_t number = server.watcher.newest().question->number;
  REQUIRE(server.client.answer(number, true));
  REQUIRE(server.watcher.sees([&](const MachineStatus& status) {
    return status.question && status.question->number != number;
  }));
  const auto late = other->answer(number, true);
  REQUIRE_FALSE(late);
  CHECK(late.error().kind == ErrorKind::refused);
  CHECK(late.error().name == "no_question");
  const auto wrong = other->answer(server.watcher.newest().question->number, true, {1.0});
  REQUIRE_FALSE(wrong);
  CHECK(wrong.error().name == "value_out_of_range");
  REQUIRE(other->answer(server.watcher.newest().question->number, true));
  REQUIRE(server.watcher.sees([](const MachineStatus& status) { return status.job.ended_well; }));
  CHECK_THAT(ctl(folder, {"answer"}).err, Contains("answer is not possible in state"));
}

TEST_CASE("A killed client that shows the question loses nothing", "[LNG-4][STA-9][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  REQUIRE(server.client.load(folder.write_job(kAskingJob)));
  const Process client = start_ctl(folder, {"run", "--wait"}, "run");
  wait_for_the_question(server);
  const Question question = *server.watcher.newest().question;
  client.signal(SIGKILL);
  const double struck = server.watcher.newest().time;
  REQUIRE(
      server.watcher.sees([&](const MachineStatus& status) { return status.time > struck + 0.5; }));
  CHECK(server.watcher.newest().state == MachineState::question);
  CHECK(server.watcher.newest().question == question);
  CHECK(ctl(folder, {"answer", "30", "20"}).exit_code == 0);
  CHECK(ended_at(server, 30.0, 20.0));
}

TEST_CASE("A stop ends the question and its program, and whoever waits is told", "[LNG-4][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  REQUIRE(server.client.load(folder.write_job(kAskingJob)));
  Process client = start_ctl(folder, {"run", "--wait"}, "run");
  wait_for_the_question(server);
  // The client follows the status by itself, and may be later than the watcher.
  for (int i = 0; i < 1000 && client.err().find("Where to?") == std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  CHECK(ctl(folder, {"stop"}).exit_code == 0);
  REQUIRE(server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::ready && !status.question;
  }));
  CHECK(server.watcher.newest().job.runs == 1);
  CHECK_FALSE(server.watcher.newest().job.ended_well);
  CHECK(client.exit_code(kPatience) == 1);
  CHECK_THAT(client.err(), Contains("The program asks: Where to?") &&
                               Contains("answer it with: cncctl answer 5 2"));
}

TEST_CASE("A sub that asks ends with the client that runs it", "[LNG-6][safety][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  server.make_ready();
  const Process client = start_ctl(folder, {"sub", "zero_z"}, "sub");
  wait_for_the_question(server);
  CHECK(server.watcher.newest().question->title == "Z zero with the probe plate");
  client.signal(SIGKILL);
  CHECK(server.watcher.sees([](const MachineStatus& status) {
    return status.state == MachineState::ready && !status.question;
  }));
}

TEST_CASE("An error in a macro names the calls that led there", "[LNG-6][e2e]") {
  const ServerFolder folder;
  RunningServer server(folder);
  config::test::put(folder.data() + "/user_macro.cnc",
                    "sub outer\ngosub inner\nendsub\nsub inner\nG77\nendsub\n");
  server.make_ready();
  REQUIRE(server.client.load(folder.write_job("G90\ngosub outer\nM30\n")));
  REQUIRE(
      server.watcher.sees([](const MachineStatus& status) { return status.job.problems == 1; }));
  const auto list = server.client.problems();
  REQUIRE(list);
  REQUIRE(list->problems.size() == 1);
  const Problem& problem = list->problems[0];
  CHECK(problem.error.place->line == 5);
  REQUIRE(problem.calls.size() == 2);
  CHECK(problem.calls[0].sub == "inner");
  CHECK(problem.calls[0].place.line == 2);
  CHECK(problem.calls[1].sub == "outer");
  CHECK(problem.calls[1].place == TextPlace{folder.file("job.nc"), 2, 0});
}
