// What programs ask: cncctl answer, the question in the status, and asking on a terminal.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "tests/api/cncctl_fixture.h"
#include "tests/api/terminal.h"

namespace cnc::test {
namespace {

using Catch::Contains;

struct Field {
  const char* label;
  double value;
};

void ask(FakeMachine& m, std::uint64_t number, const std::vector<Field>& fields) {
  m.status.set_state(v1::MACHINE_STATE_QUESTION);
  v1::Question& question = *m.status.mutable_question();
  question.Clear();
  question.set_number(number);
  question.set_title("Measure tool");
  for (const Field& field : fields) {
    v1::QuestionField& wire = *question.add_fields();
    wire.set_label(field.label);
    wire.set_value(field.value);
  }
}

const std::vector<Field> kTool{{"Tool number", 3.0}, {"Length", 42.5}};

void go_on(FakeMachine& m) {
  m.status.set_state(v1::MACHINE_STATE_RUNNING);
  m.status.clear_question();
}

/// A job that asks at once, and goes on when it is answered.
void make_asking_job(CtlFixture& f, std::vector<Field> fields = kTool) {
  f.machine.change([&](FakeMachine& m) {
    m.when_run = [fields](FakeMachine& machine) {
      start_job(machine);
      ask(machine, 7, fields);
    };
    m.when_answered = go_on;
  });
}

Outcome end_well(CtlFixture& f, Process& process) {
  f.machine.change([](FakeMachine& m) { end_job(m, true); });
  return process.wait();
}

TEST_CASE("cncctl answer sends values in order, by label, or none", "[api][cncctl][LNG-4]") {
  struct Row {
    std::vector<std::string> words;
    std::string call;
  };
  const auto [words, call] = GENERATE(values<Row>({
      {{}, "Answer 7 OK "},
      {{"4", "-1.5"}, "Answer 7 OK 4 -1.5"},
      {{"length=40"}, "Answer 7 OK 3 40"},
      {{"Length=40", "Tool number=5"}, "Answer 7 OK 5 40"},
      {{"--cancel"}, "Answer 7 Cancel "},
  }));
  CtlFixture f;
  f.machine.change([](FakeMachine& m) { ask(m, 7, kTool); });
  std::vector<std::string> arguments{"answer"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  const Outcome outcome = f.run(arguments);
  CAPTURE(arguments, outcome.err);
  CHECK(outcome.exit_code == kOk);
  CHECK(f.machine.has_seen(call));
}

TEST_CASE("cncctl answer refuses a wrong label or count and says what would be right",
          "[api][cncctl][LNG-4]") {
  struct Row {
    std::vector<std::string> words;
    std::string sentence;
  };
  const auto [words, sentence] = GENERATE(values<Row>({
      {{"Depth=4"}, "The question has no field \"Depth\"."},
      {{"4"}, "The question has 2 fields, but 1 values are given."},
      {{"4", "5", "6"}, "The question has 2 fields, but 3 values are given."},
  }));
  CtlFixture f;
  f.machine.change([](FakeMachine& m) { ask(m, 7, kTool); });
  std::vector<std::string> arguments{"answer"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  const Outcome outcome = f.run(arguments);
  CHECK(outcome.exit_code == kRefused);
  CHECK(outcome.err == "cncctl: " + sentence + " — Its fields are: \"Tool number\", \"Length\".\n");
  const std::lock_guard lock(f.machine.mutex);
  for (const std::string& call : f.machine.calls) CHECK_THAT(call, !Contains("Answer"));
}

TEST_CASE("A label that two fields have is refused", "[api][cncctl][LNG-4]") {
  CtlFixture f;
  f.machine.change([](FakeMachine& m) { ask(m, 7, {{"X", 1.0}, {"X", 2.0}}); });
  const Outcome outcome = f.run({"answer", "X=5"});
  CHECK(outcome.exit_code == kRefused);
  CHECK_THAT(outcome.err, Contains("Several fields are called \"X\""));
}

TEST_CASE("cncctl answer when nothing is asked tells the server's refusal", "[api][cncctl]") {
  CtlFixture f;
  refuse(f, "Answer");
  const Outcome outcome = f.run({"answer", "5"});
  CHECK(outcome.exit_code == kRefused);
  CHECK(outcome.err == "cncctl: The drives are off. [E5001] — cncctl reset.\n");
}

TEST_CASE("cncctl status shows the question and a command that answers it",
          "[api][cncctl][LNG-4]") {
  CtlFixture f;
  f.machine.change([](FakeMachine& m) { ask(m, 7, kTool); });
  CHECK_THAT(f.run({"status"}).out,
             Contains("question Measure tool\n         Tool number = 3\n         Length = 42.5\n"
                      "answer   cncctl answer 3 42.5, or cncctl answer --cancel\n"));
  const auto json = nlohmann::json::parse(f.run({"status", "--json"}).out);
  CHECK(json.at("question").at("number") == 7);
  CHECK(json.at("question").at("fields").at(1).at("label") == "Length");
  CHECK(json.at("question").at("fields").at(1).at("value") == 42.5);
  f.machine.change(go_on);
  CHECK(nlohmann::json::parse(f.run({"status", "--json"}).out).at("question").is_null());
}

TEST_CASE("cncctl status shows whether the probe touches", "[api][cncctl]") {
  CtlFixture f;
  CHECK_THAT(f.run({"status"}).out, Contains("probe    free\n"));
  f.machine.change([](FakeMachine& m) { m.status.set_probe_input(true); });
  CHECK_THAT(f.run({"status"}).out, Contains("probe    touches\n"));
}

TEST_CASE("Without a terminal, run --wait says how to answer and goes on waiting",
          "[api][cncctl][LNG-4]") {
  CtlFixture f;
  make_asking_job(f);
  Process process = f.start({"run", "--wait"});
  REQUIRE(process.says("answer it with: cncctl answer 3 42.5, or cncctl answer --cancel"));
  f.machine.change(go_on);
  const Outcome outcome = end_well(f, process);
  CHECK(outcome.exit_code == kOk);
  CHECK_THAT(outcome.err, Contains("The program asks: Measure tool\n  Tool number = 3\n"));
}

TEST_CASE("On a terminal, run asks field by field; Enter keeps a value", "[api][cncctl][LNG-4]") {
  CtlFixture f;
  make_asking_job(f);
  const Terminal terminal;
  Process process = f.start({"run", "--wait"}, terminal.path());
  REQUIRE(process.says("Tool number [3]: "));
  terminal.type("\n");
  REQUIRE(process.says("Length [42.5]: "));
  terminal.type("long\n");
  REQUIRE(process.says("\"long\" is not a number"));
  terminal.type("40\n");
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.saw("Answer 7 OK 3 40"); }));
  CHECK(end_well(f, process).exit_code == kOk);
}

TEST_CASE("On a terminal, \"cancel\" cancels, and a question without fields wants a word",
          "[api][cncctl][LNG-4]") {
  struct Row {
    std::vector<Field> fields;
    std::string prompt;
    std::string typed;
    std::string call;
  };
  const auto [fields, prompt, typed, call] = GENERATE(values<Row>({
      {kTool, "Tool number [3]: ", "cancel\n", "Answer 7 Cancel "},
      {{}, "ok or cancel? ", "\nok\n", "Answer 7 OK "},
      {{}, "ok or cancel? ", "no\n", "Answer 7 Cancel "},
  }));
  CtlFixture f;
  make_asking_job(f, fields);
  const Terminal terminal;
  Process process = f.start({"run", "--wait"}, terminal.path());
  REQUIRE(process.says(prompt));
  terminal.type(typed);
  REQUIRE(f.machine.becomes([call = call](FakeMachine& m) { return m.saw(call); }));
  CHECK(end_well(f, process).exit_code == kOk);
}

TEST_CASE("An Enter from before the question is no answer to it", "[api][cncctl][safety]") {
  CtlFixture f;
  f.machine.change([](FakeMachine& m) { m.when_run = start_job; });
  const Terminal terminal;
  Process process = f.start({"run", "--wait"}, terminal.path());
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.saw("Run"); }));
  terminal.type("\n\n\n");
  f.machine.change([](FakeMachine& m) { ask(m, 7, kTool); });
  REQUIRE(process.says("Tool number [3]: "));
  f.machine.change(go_on);
  CHECK_THAT(end_well(f, process).err, !Contains("Length [42.5]"));
}

TEST_CASE("A question that somebody else answers leaves the terminal", "[api][cncctl][LNG-4]") {
  CtlFixture f;
  make_asking_job(f);
  const Terminal terminal;
  Process process = f.start({"run", "--wait"}, terminal.path());
  REQUIRE(process.says("Tool number [3]: "));
  f.machine.change(go_on);
  REQUIRE(process.says("the question has been answered elsewhere"));
  CHECK(end_well(f, process).exit_code == kOk);
}

TEST_CASE("Ctrl-D at a prompt leaves the answer to others", "[api][cncctl][LNG-4]") {
  CtlFixture f;
  make_asking_job(f);
  const Terminal terminal;
  Process process = f.start({"run", "--wait"}, terminal.path());
  REQUIRE(process.says("Tool number [3]: "));
  terminal.type(Terminal::kControlD);
  REQUIRE(process.says("not answered here; answer it with: cncctl answer 3 42.5"));
  f.machine.change(go_on);
  CHECK(end_well(f, process).exit_code == kOk);
}

TEST_CASE("A refused answer is told, and the question asked again while it stands",
          "[api][cncctl][LNG-4]") {
  CtlFixture f;
  make_asking_job(f, {{"Depth", 5.0}});
  refuse(f, "Answer");
  const Terminal terminal;
  Process process = f.start({"run", "--wait"}, terminal.path());
  REQUIRE(process.says("Depth [5]: "));
  terminal.type("6\n");
  REQUIRE(process.says("The drives are off. [E5001]"));
  f.machine.change([](FakeMachine& m) { m.failures.clear(); });
  REQUIRE(process.says("[E5001] — cncctl reset.\nThe program asks: Measure tool"));
  f.machine.change(go_on);
  CHECK(end_well(f, process).exit_code == kOk);
}

TEST_CASE("run --go-on says OK to what is proposed", "[api][cncctl][LNG-4]") {
  CtlFixture f;
  make_asking_job(f);
  Process process = f.start({"run", "--go-on"});
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.saw("Answer 7 OK "); }));
  CHECK(end_well(f, process).exit_code == kOk);
}

TEST_CASE("With --json a question is an object on stdout and is not asked", "[api][cncctl]") {
  CtlFixture f;
  make_asking_job(f);
  const Terminal terminal;
  Process process = f.start({"run", "--wait", "--json"}, terminal.path());
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.status.sequence() >= 3; }));
  f.machine.change(go_on);
  const Outcome outcome = end_well(f, process);
  CHECK(outcome.exit_code == kOk);
  CHECK(nlohmann::json::parse(outcome.out).at("question").at("title") == "Measure tool");
  CHECK(outcome.err.empty());
}

TEST_CASE("run --wait waits on while the operator jogs and while the program homes",
          "[api][cncctl][JOB-8]") {
  const auto state = GENERATE(v1::MACHINE_STATE_JOGGING, v1::MACHINE_STATE_HOMING);
  CtlFixture f;
  f.machine.change([](FakeMachine& m) { m.when_run = start_job; });
  Process process = f.start({"run", "--progress", "--json"});
  const auto after = [&](std::uint64_t statuses) {
    std::uint64_t begin = 0;
    f.machine.change([&](FakeMachine& m) { begin = m.status.sequence(); });
    return f.machine.becomes(
        [&](FakeMachine& m) { return m.status.sequence() >= begin + statuses; });
  };
  REQUIRE(after(3));
  f.machine.change([&](FakeMachine& m) { m.status.set_state(state); });
  REQUIRE(after(3));
  f.machine.change([](FakeMachine& m) { m.status.set_state(v1::MACHINE_STATE_RUNNING); });
  REQUIRE(after(3));
  CHECK(end_well(f, process).exit_code == kOk);
}

TEST_CASE("cncctl sub shows what the sub asks and waits for its end", "[api][cncctl][LNG-6]") {
  CtlFixture f;
  f.machine.change([](FakeMachine& m) {
    m.hold_motion = true;
    ask(m, 7, kTool);
    m.when_answered = [](FakeMachine& machine) {
      go_on(machine);
      machine.hold_motion = false;
    };
  });
  const Terminal terminal;
  Process process = f.start({"sub", "user_2"}, terminal.path());
  REQUIRE(process.says("Tool number [3]: "));
  terminal.type("\n\n");
  CHECK(process.wait().exit_code == kOk);
  CHECK(f.machine.has_seen("RunSub user_2"));
  CHECK(f.machine.has_seen("Answer 7 OK 3 42.5"));
}

TEST_CASE("Ctrl-C during cncctl sub stops the machine and says so", "[api][cncctl][safety]") {
  CtlFixture f;
  f.machine.change([](FakeMachine& m) { m.hold_motion = true; });
  Process process = f.start({"sub", "user_1"});
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.saw("RunSub user_1"); }));
  process.signal(SIGINT);
  const Outcome outcome = process.wait();
  CHECK(outcome.exit_code == kInterrupted);
  CHECK_THAT(outcome.err, Contains("the machine stops"));
  CHECK(f.machine.becomes([](FakeMachine& m) { return m.cancelled_calls == 1; }));
}

}  // namespace
}  // namespace cnc::test
