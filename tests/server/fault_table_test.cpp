// Every fault that a scenario can bring about, and pairs of them, at a hundred random instants of a
// job each: what becomes of the job, of the machine, of spindle and coolant, and of what is known
// of the position. Prints the table. In virtual time, the same in every run.
#include <catch2/catch.hpp>
#include <fmt/core.h>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

constexpr int kInstants = 100;

// A cut with a rounded corner, a dwell, a thread at the spindle's pace and a way back, from and to
// one place. X, Y and Z move, together and by themselves.
constexpr std::string_view kJob =
    "HomeIsEstop on\n"
    "M3 S1200\nM8\n"
    "G91 G64 P0.5\n"
    "G1 X20 F3000\nY20\n"
    "G4 P0.2\n"
    "G33 Z-10 K1\n"
    "G0 Z10\n"
    "G1 X-20 Z-2\nY-20 Z2\n"
    "M30\n";

class FaultRig : public Rig {
 public:
  /// `encoders`: the drives have them, and hold their position while they are off.
  FaultRig(double period, bool encoders)
      : Rig(shipped_machine(
                {encoders ? "SAFETY.drivesHoldPosition=1" : "SAFETY.drivesHoldPosition=0",
                 "AXIS_X.homeVelocity=0", "AXIS_Y.homeVelocity=0", "AXIS_Z.homeVelocity=0",
                 "SPINDLE_0.spindleRampUpTime=0.3",
                 "GPIO_RULES.card_1_rule_1_inputParticipantBits=1",
                 "GPIO_RULES.card_1_rule_1_inputCompareBits=1", "GPIO_RULES.card_1_rule_1_action=2",
                 "GPIO_RULES.card_1_rule_2_inputParticipantBits=2",
                 "GPIO_RULES.card_1_rule_2_inputCompareBits=2",
                 "GPIO_RULES.card_1_rule_2_action=3"}),
            options(period)) {
    REQUIRE(reset());
    REQUIRE(home());
    REQUIRE(mdi("G0 X100 Y100 Z0"));
    frame_ = bench().physical_position() - position();
    for (const Axis axis : kAllAxes) lost_[axis] = bench().lost_steps(axis);
  }

  hal::sim::VirtualController& board() { return simulation.virtual_controller(); }
  hal::sim::VirtualMachine& bench() { return simulation.virtual_machine(); }
  hal::sim::LinkTrouble& line() { return board().trouble(); }

  /// Where the machine really stands, in the server's coordinates.
  Position truth() { return bench().physical_position() - frame_; }

  /// An axis counts as trusted, and stands elsewhere than the server says, or its motor has not
  /// followed every pulse.
  bool trust_claims_too_much() {
    for (const Axis axis : kLinearAxes) {
      if (shown()->trust[axis] != Trust::trusted) continue;
      const double step = 1.0 / std::abs(machine.config().axes[axis].steps_per_unit);
      if (std::abs(truth()[axis] - position()[axis]) >= step) return true;
      if (bench().lost_steps(axis) != lost_[axis]) return true;
    }
    return false;
  }

  /// How far the machine stands outside of its limits, mm; below 0: inside.
  double beyond_limits() {
    double furthest = -std::numeric_limits<double>::infinity();
    for (const Axis axis : kLinearAxes) {
      const config::AxisConfig& limits = machine.config().axes[axis];
      const double at = truth()[axis];
      furthest = std::max({furthest, at - limits.positive_limit, limits.negative_limit - at});
    }
    return furthest;
  }

 private:
  static SimulationOptions options(double period) {
    SimulationOptions options{.period = period};
    options.machine.start = Position{};
    options.machine.door = hal::sim::DoorOptions{.in_estop_chain = true};
    for (const Axis axis : kLinearAxes) {
      options.machine.axes[axis].motor.closed_loop = true;
      options.machine.axes[axis].limits_in_estop_chain = true;
    }
    return options;
  }

  Position frame_;
  AxisArray<std::uint64_t> lost_{};
};

/// What has to become of the job.
enum class Fate : std::uint8_t {
  ends,     ///< it is stopped, whenever the fault comes
  may_end,  ///< it is stopped where the fault matters, and else goes on to its end
  goes_on,  ///< to its end, and every step is made
};

struct Fault {
  std::string_view name;
  Fate fate;
  void (*strike)(FaultRig&);
  double lasts = std::numeric_limits<double>::infinity();  ///< s
  void (*heal)(FaultRig&) = nullptr;
  bool costs_trust = false;  ///< whenever it comes
  bool encoders = true;      ///< of the drives
};

/// One fault, and another behind its beginning, somewhere between two times.
struct Pair {
  std::string_view name;
  Fault first;
  Fault second;
  double soonest = 0.005;  ///< s
  double latest = 0.1;
};

using hal::sim::VirtualMotor;

void pull_cable(FaultRig& rig) { rig.line().cable_out = true; }
void plug_cable(FaultRig& rig) { rig.line().cable_out = false; }
void set_card_input(FaultRig& rig, int port) {
  rig.bench().set_port_input(*hal::port_bit(port), true);
}

constexpr std::array kFaults{
    Fault{"cable out for 0.08 s", Fate::goes_on, pull_cable, 0.08, plug_cable},
    Fault{"cable out for 0.12 s", Fate::may_end, pull_cable, 0.12, plug_cable},
    Fault{"cable out for 0.2 s", Fate::ends, pull_cable, 0.2, plug_cable},
    Fault{"cable out for 0.3 s", Fate::ends, pull_cable, 0.3, plug_cable},
    Fault{"cable out for 1 s", Fate::ends, pull_cable, 1.0, plug_cable},
    Fault{"cable out for good", Fate::ends, pull_cable},
    Fault{"5 % lost, 20 ms of jitter", Fate::goes_on,
          [](FaultRig& rig) { rig.line().loss = 0.05, rig.line().jitter = 0.02; }},
    Fault{"delayed by 30 ms", Fate::goes_on, [](FaultRig& rig) { rig.line().delay = 0.03; }},
    Fault{"30 % doubled, reordered", Fate::goes_on,
          [](FaultRig& rig) { rig.line().duplication = 0.3, rig.line().jitter = 0.02; }},
    Fault{"20 % corrupted", Fate::goes_on, [](FaultRig& rig) { rig.line().corruption = 0.2; }},
    Fault{"70 % lost", Fate::may_end, [](FaultRig& rig) { rig.line().loss = 0.7; }},
    Fault{.name = "board reset",
          .fate = Fate::ends,
          .strike = [](FaultRig& rig) { rig.board().board().reset(); },
          .costs_trust = true},
    Fault{"server too busy for 0.4 s", Fate::may_end,
          [](FaultRig& rig) { rig.simulation.starve_machine(0.4); }},
    Fault{"emergency stop, channel 1", Fate::ends,
          [](FaultRig& rig) { rig.bench().press_estop(true); }},
    Fault{.name = "emergency stop, drives without encoders",
          .fate = Fate::ends,
          .strike = [](FaultRig& rig) { rig.bench().press_estop(true); },
          .costs_trust = true,
          .encoders = false},
    Fault{"emergency stop, channel 2", Fate::ends,
          [](FaultRig& rig) { rig.bench().press_estop2(true); }},
    Fault{"door open", Fate::ends, [](FaultRig& rig) { rig.bench().open_door(true); }},
    Fault{"limit switch stuck", Fate::ends,
          [](FaultRig& rig) {
            rig.bench().stick_switch(Axis::Y, VirtualMotor::Switch::limit_high, true);
          }},
    Fault{
        "home switch stuck", Fate::ends,
        [](FaultRig& rig) { rig.bench().stick_switch(Axis::X, VirtualMotor::Switch::home, true); }},
    Fault{.name = "8 steps lost",
          .fate = Fate::ends,
          .strike = [](FaultRig& rig) { rig.bench().lose_steps(Axis::X, 8); },
          .costs_trust = true},
    Fault{.name = "drive alarm",
          .fate = Fate::ends,
          .strike = [](FaultRig& rig) { rig.bench().raise_drive_alarm(Axis::Z, true); },
          .costs_trust = true},
    Fault{"guard rule, smooth stop", Fate::ends, [](FaultRig& rig) { set_card_input(rig, 101); }},
    Fault{"guard rule, quick stop", Fate::ends, [](FaultRig& rig) { set_card_input(rig, 102); }},
    Fault{"index missing", Fate::may_end,
          [](FaultRig& rig) { rig.bench().set_index_missing(true); }},
    Fault{"probe stuck", Fate::goes_on, [](FaultRig& rig) { rig.bench().stick_probe(true); }},
    Fault{"external error", Fate::goes_on,
          [](FaultRig& rig) { rig.bench().raise_external_error(true); }},
};

// A board that hears nothing waits for 0.1 s and then brakes, for 0.2 s at the most.
constexpr double kSilent = 0.1;
constexpr double kBraked = 0.3;

constexpr Fault fault(std::string_view name) {
  for (const Fault& row : kFaults)
    if (row.name == name) return row;
  throw "no such fault";  // does not compile
}

constexpr Fault kCableOut = fault("cable out for good");
constexpr Fault kCableLoose = fault("cable out for 0.08 s");
constexpr Fault kCableBack = fault("cable out for 0.3 s");
constexpr Fault kCableLate = fault("cable out for 1 s");
constexpr Fault kEstop = fault("emergency stop, channel 1");
constexpr Fault kReset = fault("board reset");
constexpr Fault kAlarm = fault("drive alarm");
constexpr Fault kGuardStop = fault("guard rule, smooth stop");
constexpr Fault kGuardQuickStop = fault("guard rule, quick stop");
constexpr Fault kStepsLost = fault("8 steps lost");
constexpr Fault kBusy = fault("server too busy for 0.4 s");
constexpr Fault kDoor = fault("door open");
constexpr Fault kHalfDeaf = fault("70 % lost");
constexpr Fault kEstopTapped{"emergency stop pressed for 20 ms", Fate::ends,
                             [](FaultRig& rig) { rig.bench().press_estop(true); }, 0.02,
                             [](FaultRig& rig) { rig.bench().press_estop(false); }};
constexpr Fault kPaused{"pause", Fate::may_end,
                        [](FaultRig& rig) { rig.machine.pause([](const Result<void>&) {}); }};
constexpr Fault kStopped{"stop", Fate::ends,
                         [](FaultRig& rig) { rig.machine.stop([](const Result<void>&) {}); }};

constexpr std::array kPairs{
    Pair{"emergency stop, then cable out", kEstop, kCableOut},
    Pair{"emergency stop of 20 ms, then drive alarm", kEstopTapped, kAlarm},
    Pair{"emergency stop, then board reset", kEstop, kReset},
    Pair{"cable loose, then emergency stop", kCableLoose, kEstop},
    Pair{"link lost, emergency stop while it brakes", kCableBack, kEstop, kSilent, kBraked},
    Pair{"link lost, guard while it brakes", kCableLate, kGuardStop, kSilent, kBraked},
    Pair{"link lost, board reset while it brakes", kCableLate, kReset, kSilent, kBraked},
    Pair{"guard stop, then 8 steps lost", kGuardStop, kStepsLost},
    Pair{"guard stop, then board reset", kGuardStop, kReset},
    Pair{"guard stop, then cable out", kGuardStop, kCableOut},
    Pair{"guard stop, then drive alarm", kGuardStop, kAlarm},
    Pair{"guard stop, then emergency stop of 20 ms", kGuardStop, kEstopTapped},
    Pair{"guard stop, then quick stop by another", kGuardStop, kGuardQuickStop},
    Pair{"guard stop, then server too busy", kGuardStop, kBusy},
    Pair{"70 % lost, then guard stop", kHalfDeaf, kGuardStop},
    Pair{"pause, then guard stop", kPaused, kGuardStop},
    Pair{"pause, then drive alarm", kPaused, kAlarm},
    Pair{"stop, then door open", kStopped, kDoor},
    Pair{"stop, then cable out", kStopped, kCableOut},
    Pair{"board reset, then emergency stop", kReset, kEstop},
};

/// Of all instants of one fault.
struct Outcome {
  int ended = 0;              ///< jobs that did not come to their end
  int wrong = 0;              ///< … although they should have, or the other way round
  int still_moving = 0;       ///< after a job that ended
  int spindle_on = 0;         ///< after the job, however it ended
  int flood_on = 0;           ///< after the job
  int in_doubt = 0;           ///< an axis is not trusted
  int claims_too_much = 0;    ///< trust that is wrong
  int elsewhere = 0;          ///< a job came to its end, the machine not to its place
  double slowest_stop = 0.0;  ///< s
  double beyond_limits = -std::numeric_limits<double>::infinity();  ///< mm
};

/// Something that is done to the machine.
struct Deed {
  double at;  ///< s
  void (*act)(FaultRig&);
};

void plan(std::vector<Deed>& deeds, const Fault& fault, double at) {
  deeds.push_back({at, fault.strike});
  if (fault.heal != nullptr) deeds.push_back({at + fault.lasts, fault.heal});
}

/// Does what is planned, until the job has ended and the machine has stood still for half a second;
/// returns the time of the last motion, s behind the first deed.
double run_out(FaultRig& rig, std::vector<Deed> deeds, Outcome& outcome) {
  constexpr double kLongest = 20.0;  // s; a spindle that gives no index is waited for, for 10 s
  constexpr double kRest = 0.5;      // s
  std::ranges::sort(deeds, {}, &Deed::at);
  const double begin = deeds.front().at;
  double moved = begin;
  double worked = begin;
  Position last = rig.truth();
  auto next = deeds.begin();
  for (double now = rig.simulation.time(); now < begin + kLongest; now = rig.simulation.time()) {
    for (; next != deeds.end() && now >= next->at; ++next) next->act(rig);
    rig.simulation.cycle();
    if (rig.truth() != last) moved = now;
    if (rig.state() == State::running) worked = now;
    last = rig.truth();
    outcome.beyond_limits = std::max(outcome.beyond_limits, rig.beyond_limits());
    if (now > std::max({moved, worked, deeds.back().at}) + kRest) return moved - begin;
  }
  ++outcome.still_moving;
  return kLongest;
}

/// The job as nothing disturbs it.
struct Whole {
  Position end;
  double time;  // s
};

Whole undisturbed() {
  FaultRig rig(0.005, true);
  rig.start(std::string(kJob));
  const double begin = rig.simulation.time();
  REQUIRE(rig.becomes(State::ready, 10.0));
  REQUIRE(rig.shown()->job.ended_well);
  REQUIRE(rig.bench().flood_time() > 0.0);
  return {rig.truth(), rig.simulation.time() - begin};
}

/// The second fault, if there is one, comes `soonest` to `latest` behind the first.
void strike_once(const Fault& first, const Pair* pair, std::mt19937& random, const Whole& whole,
                 Outcome& outcome) {
  std::uniform_real_distribution<double> part(0.0, 1.0);
  // A cycle of another length each time: the fault meets the board's and the job's every phase.
  FaultRig rig(0.004 + 0.002 * part(random), first.encoders);
  rig.start(std::string(kJob));
  // The second fault has to meet a job too.
  const double latest = 0.98 * whole.time - (pair != nullptr ? pair->latest : 0.0);
  rig.run_for(latest * part(random));
  REQUIRE(rig.state() == State::running);
  const double begin = rig.simulation.time();
  std::vector<Deed> deeds;
  plan(deeds, first, begin);
  if (pair != nullptr) {
    const double behind = pair->soonest + (pair->latest - pair->soonest) * part(random);
    plan(deeds, pair->second, begin + behind);
  }
  const double stop = run_out(rig, std::move(deeds), outcome);
  const bool ended = !rig.shown()->job.ended_well;
  outcome.ended += ended ? 1 : 0;
  const auto has_fate = [&](Fate fate) {
    return first.fate == fate || (pair != nullptr && pair->second.fate == fate);
  };
  const bool is_wrong =
      ended ? !has_fate(Fate::ends) && !has_fate(Fate::may_end) : has_fate(Fate::ends);
  outcome.wrong += is_wrong ? 1 : 0;
  if (ended)
    outcome.slowest_stop = std::max(outcome.slowest_stop, stop);
  else if (rig.truth() != whole.end)
    ++outcome.elsewhere;
  outcome.spindle_on += rig.bench().outputs().spindle_on ? 1 : 0;
  outcome.flood_on += rig.bench().outputs().flood ? 1 : 0;
  const AxisArray<Trust>& trust = rig.shown()->trust;
  const bool in_doubt =
      std::ranges::any_of(kLinearAxes, [&](Axis axis) { return trust[axis] != Trust::trusted; });
  outcome.in_doubt += in_doubt ? 1 : 0;
  outcome.claims_too_much += rig.trust_claims_too_much() ? 1 : 0;
}

void print_head(std::string_view what) {
  fmt::print(
      "\n| {} | jobs ended | still after, s | spindle on | flood on | in doubt | trusted wrongly "
      "| mm inside the limits |\n|---|---:|---:|---:|---:|---:|---:|---:|\n",
      what);
}

void strike(std::string_view name, const Fault& first, const Pair* pair, const Whole& whole) {
  INFO(name);
  std::mt19937 random(1);
  Outcome outcome;
  for (int i = 0; i < kInstants; ++i) strike_once(first, pair, random, whole, outcome);
  fmt::print("| {} | {} | {:.3f} | {} | {} | {} | {} | {:.1f} |\n", name, outcome.ended,
             outcome.slowest_stop, outcome.spindle_on, outcome.flood_on, outcome.in_doubt,
             outcome.claims_too_much, -outcome.beyond_limits);
  CHECK(outcome.wrong == 0);
  CHECK(outcome.still_moving == 0);
  CHECK(outcome.spindle_on == 0);
  CHECK(outcome.flood_on == 0);
  CHECK(outcome.claims_too_much == 0);
  if (first.costs_trust || (pair != nullptr && pair->second.costs_trust))
    CHECK(outcome.in_doubt == kInstants);
  CHECK(outcome.elsewhere == 0);
  CHECK(outcome.beyond_limits <= 0.0);
}

}  // namespace

TEST_CASE("Any fault, at any instant of a job: the table of outcomes", "[LNK-4][STA-4][safety]") {
  const Whole whole = undisturbed();
  print_head("fault");
  for (const Fault& fault : kFaults) strike(fault.name, fault, nullptr, whole);
}

TEST_CASE("A fault behind another, at any instant of a job: the table of outcomes",
          "[LNK-4][STA-4][safety]") {
  const Whole whole = undisturbed();
  print_head("faults");
  for (const Pair& pair : kPairs) strike(pair.name, pair.first, &pair, whole);
}
