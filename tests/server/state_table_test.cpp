// STA-1: which command is allowed in which state.
//
// The table below is derived from the features, not from the code: reset switches on, recovers and
// ends whatever runs (STA-2, manual 2.2.2); before homing there is no job and no single line
// (STA-5); jog, homing and zeroing need a machine that does nothing else; pause and stop need
// something that runs, resume something that waits (JOB-1, JOB-8); a program can be exchanged while
// none is executed; overrides are never refused (MAN-8).
#include "server/machine/state_table.h"

#include <catch2/catch.hpp>
#include <memory>
#include <string_view>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

namespace {

struct Row {
  State state;
  // reset home jog mdi load run pause resume stop rewind override zero answer accept
  std::string_view allowed;
};

constexpr std::array<Row, kStateCount> kExpected{{
    {State::off, "....l....wO..."},
    {State::needs_reset, "R...l....wO..."},
    {State::needs_homing, "Rhj.l....wOz.T"},
    {State::ready, "Rhjmlr...wOz.T"},
    {State::jogging, "R.j.l...s.O..."},
    {State::homing, "R...l...s.O..."},
    {State::mdi, "R.....p.s.O..."},
    {State::running, "R.....p.s.O..."},
    {State::pausing, "R.......s.O..."},
    {State::paused, "R......gs.O..."},
    {State::program_stop, "R.j....gs.O..."},
    {State::tool_change, "R.j....gs.O..."},
    {State::question, "R.j.....s.O.A."},
    {State::stopping, "R.........O..."},
    {State::estop, "R...l....wO..."},
    {State::error, "R...l....wO..."},
}};

constexpr std::string_view kProgram = "G1 X50 F600\nM0\nM6 T1\ndlgmsg \"t\"\nG1 X0\n";

void ignore(const Result<void>&) {}

/// A machine in the state, brought there the way an operator would. `off` is one that has not seen
/// its board yet.
std::unique_ptr<Rig> machine_in(State state) {
  if (state == State::needs_homing) {
    auto rig = std::make_unique<Rig>(shipped_machine());
    REQUIRE(rig->reset());
    REQUIRE(rig->load(std::string(kProgram)));
    return rig;
  }
  auto rig = std::make_unique<Rig>();
  REQUIRE(rig->load(std::string(kProgram)));
  Machine& machine = rig->machine;
  const auto run_until = [&](State wanted) {
    REQUIRE(machine.run());
    REQUIRE(rig->becomes(wanted));
  };
  switch (state) {
    case State::off:
    case State::needs_reset:
    case State::needs_homing:
      return rig;
    case State::estop:
      rig->simulation.virtual_machine().press_estop(true);
      REQUIRE(rig->becomes(State::estop));
      return rig;
    case State::error:  // the board refuses a segment that does not follow the one before it
      REQUIRE(rig->reset());
      rig->simulation.link().push(hal::Segment{.id = 1, .duration = -1.0});
      REQUIRE(rig->becomes(State::error));
      return rig;
    default:
      REQUIRE(rig->reset());
  }
  switch (state) {
    case State::jogging:
      REQUIRE(machine.jog_step(Axis::X, 10.0, 0.1));
      break;
    case State::homing:
      machine.home({Axis::X}, ignore);
      break;
    case State::mdi:
      machine.mdi("G0 X100", ignore);
      break;
    case State::running:
    case State::pausing:
    case State::paused:
    case State::stopping:
      run_until(State::running);
      rig->run_for(1.0);
      if (state == State::running) break;
      if (state == State::stopping)
        machine.stop(ignore);
      else
        machine.pause(ignore);
      if (state == State::paused) REQUIRE(rig->becomes(State::paused));
      break;
    case State::program_stop:
      run_until(State::program_stop);
      break;
    case State::tool_change:
    case State::question:
      run_until(State::program_stop);
      REQUIRE(machine.resume());
      REQUIRE(rig->becomes(State::tool_change));
      if (state == State::tool_change) break;
      REQUIRE(machine.resume());
      REQUIRE(rig->becomes(State::question));
      break;
    default:
      break;
  }
  return rig;
}

/// The machine's answer at once: a command that takes time has not answered yet when it was
/// accepted.
Result<void> give(Rig& rig, CommandKind command) {
  auto answer = std::make_shared<Result<void>>();
  const Completion note = [answer](Result<void> result) { *answer = std::move(result); };
  Machine& machine = rig.machine;
  switch (command) {
    case CommandKind::reset:
      machine.reset(note);
      break;
    case CommandKind::home:
      machine.home({}, note);
      break;
    case CommandKind::jog:
      return machine.jog({}, 0.25);
    case CommandKind::mdi:
      machine.mdi("G0 X1", note);
      break;
    case CommandKind::load:
      return rig.load("M30\n");
    case CommandKind::run:
      return machine.run();
    case CommandKind::pause:
      machine.pause(note);
      break;
    case CommandKind::resume:
      return machine.resume();
    case CommandKind::stop:
      machine.stop(note);
      break;
    case CommandKind::rewind:
      return machine.rewind();
    case CommandKind::set_override:
      if (auto set = machine.set_overrides({.feed = 0.5}); !set)
        return std::unexpected(set.error());
      break;
    case CommandKind::set_work_zero:
      return machine.set_work_zero({{Axis::X, 0.0}});
    case CommandKind::answer:
      return machine.answer(1, true, {});
    case CommandKind::accept_position: {
      const Result<void> accepted = machine.accept_position({Axis::X});
      // These machines were never homed: the state lets the command through, X does not.
      const bool reached_x = !accepted && accepted.error().code == ErrorCode::never_homed;
      return reached_x ? Result<void>{} : accepted;
    }
  }
  return *answer;
}

}  // namespace

TEST_CASE("Every command is allowed in exactly the states that the features say", "[STA-1]") {
  for (const Row& row : kExpected) {
    for (const CommandRule& rule : command_table()) {
      INFO(rule.name << " in state " << state_info(row.state).name);
      const bool allowed = row.allowed[static_cast<std::size_t>(rule.command)] != '.';
      CHECK(is_allowed(rule.command, row.state) == allowed);
    }
  }
}

TEST_CASE("A refusal names the command, the state and what is needed", "[STA-1]") {
  for (const StateInfo& state : state_table()) {
    for (const CommandRule& rule : command_table()) {
      const auto reason = refusal(rule.command, state.state);
      CHECK(reason.has_value() != is_allowed(rule.command, state.state));
      if (!reason) continue;
      CHECK_THAT(*reason, Contains(std::string(rule.name)) && Contains(std::string(state.name)) &&
                              Contains(std::string(state.waits)));
    }
  }
}

TEST_CASE("The machine in each state obeys the table and a refusal changes nothing",
          "[STA-1][STA-2][STA-5]") {
  for (const Row& row : kExpected) {
    if (row.state == State::off) continue;  // the next test
    for (const CommandRule& rule : command_table()) {
      INFO(rule.name << " in state " << state_info(row.state).name);
      const auto rig = machine_in(row.state);
      REQUIRE(rig->state() == row.state);
      const auto before = rig->machine.program();
      const Result<void> answer = give(*rig, rule.command);
      const bool allowed = row.allowed[static_cast<std::size_t>(rule.command)] != '.';
      CHECK(answer.has_value() == allowed);
      if (allowed || answer) continue;
      CHECK(answer.error().code == ErrorCode::command_not_allowed);
      CHECK_THAT(answer.error().message, Contains(std::string(state_info(row.state).name)));
      CHECK(rig->state() == row.state);
      CHECK(rig->machine.program() == before);
    }
  }
}

TEST_CASE("A machine without a controller is off, and nothing can be started", "[STA-1]") {
  MessageLog log;
  Link link(nullptr);  // is never cycled: no status comes from a board
  Machine machine(free_machine(), link, log);
  machine.cycle(0.0);
  REQUIRE(machine.state() == State::off);
  machine.reset([](const Result<void>& answer) {
    REQUIRE_FALSE(answer);
    CHECK(answer.error().code == ErrorCode::command_not_allowed);
    CHECK_THAT(answer.error().message, Contains("No controller is connected"));
  });
  CHECK_FALSE(machine.run());
  CHECK_FALSE(machine.jog({}, 0.25));
  CHECK_FALSE(machine.set_work_zero({{Axis::X, 0.0}}));
  CHECK(machine.rewind());
  CHECK(machine.set_overrides({}));
}
