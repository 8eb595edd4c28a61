// Every fault that a scenario can bring about, at a hundred random instants of a job each: what
// becomes of the job, of the machine, of the spindle, and of what is known of the position. Prints
// the table. In virtual time, the same in every run.
#include <catch2/catch.hpp>
#include <fmt/core.h>
#include <limits>
#include <random>

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
  explicit FaultRig(double period)
      : Rig(shipped_machine({"AXIS_X.homeVelocity=0", "AXIS_Y.homeVelocity=0",
                             "AXIS_Z.homeVelocity=0", "SPINDLE_0.spindleRampUpTime=0.3",
                             "GPIO_RULES.card_1_rule_1_inputParticipantBits=1",
                             "GPIO_RULES.card_1_rule_1_inputCompareBits=1",
                             "GPIO_RULES.card_1_rule_1_action=2",
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
};

using hal::sim::VirtualMotor;

void pull_cable(FaultRig& rig) { rig.line().cable_out = true; }
void plug_cable(FaultRig& rig) { rig.line().cable_out = false; }
void set_card_input(FaultRig& rig, int port) {
  rig.bench().set_port_input(*hal::port_bit(port), true);
}

constexpr std::array kFaults{
    Fault{"cable out for 0.1 s", Fate::goes_on, pull_cable, 0.1, plug_cable},
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
    Fault{"board reset", Fate::ends, [](FaultRig& rig) { rig.board().board().reset(); }},
    Fault{"server too busy for 0.4 s", Fate::may_end,
          [](FaultRig& rig) { rig.simulation.starve_machine(0.4); }},
    Fault{"emergency stop, channel 1", Fate::ends,
          [](FaultRig& rig) { rig.bench().press_estop(true); }},
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
    Fault{"8 steps lost", Fate::ends, [](FaultRig& rig) { rig.bench().lose_steps(Axis::X, 8); }},
    Fault{"drive alarm", Fate::ends,
          [](FaultRig& rig) { rig.bench().raise_drive_alarm(Axis::Z, true); }},
    Fault{"guard rule, smooth stop", Fate::ends, [](FaultRig& rig) { set_card_input(rig, 101); }},
    Fault{"guard rule, quick stop", Fate::ends, [](FaultRig& rig) { set_card_input(rig, 102); }},
    Fault{"index missing", Fate::may_end,
          [](FaultRig& rig) { rig.bench().set_index_missing(true); }},
    Fault{"probe stuck", Fate::goes_on, [](FaultRig& rig) { rig.bench().stick_probe(true); }},
    Fault{"external error", Fate::goes_on,
          [](FaultRig& rig) { rig.bench().raise_external_error(true); }},
};

/// Of all instants of one fault.
struct Outcome {
  int ended = 0;              ///< jobs that did not come to their end
  int wrong = 0;              ///< … although they should have, or the other way round
  int still_moving = 0;       ///< after a job that ended
  int spindle_on = 0;         ///< after a job that ended
  int in_doubt = 0;           ///< an axis is not trusted
  int claims_too_much = 0;    ///< trust that is wrong
  int elsewhere = 0;          ///< a job came to its end, the machine not to its place
  double slowest_stop = 0.0;  ///< s
  double beyond_limits = -std::numeric_limits<double>::infinity();  ///< mm
};

/// Runs until the job has ended and the machine has stood still for half a second; returns the time
/// of the last motion, s behind the fault's `begin`.
double run_out(FaultRig& rig, const Fault& fault, double begin, Outcome& outcome) {
  constexpr double kLongest = 20.0;  // s; a spindle that gives no index is waited for, for 10 s
  constexpr double kRest = 0.5;      // s
  const double healed = begin + fault.lasts;
  double moved = begin;
  double worked = begin;
  Position last = rig.truth();
  for (double now = rig.simulation.time(); now < begin + kLongest; now = rig.simulation.time()) {
    if (fault.heal != nullptr && now >= healed) fault.heal(rig);
    rig.simulation.cycle();
    if (rig.truth() != last) moved = now;
    if (rig.state() == State::running) worked = now;
    last = rig.truth();
    outcome.beyond_limits = std::max(outcome.beyond_limits, rig.beyond_limits());
    if (now > std::max({moved, worked, fault.heal != nullptr ? healed : 0.0}) + kRest)
      return moved - begin;
  }
  ++outcome.still_moving;
  return kLongest;
}

/// The job as nothing disturbs it.
struct Whole {
  Position end;
  double time;  // s
};

void strike_once(const Fault& fault, std::mt19937& random, const Whole& whole, Outcome& outcome) {
  std::uniform_real_distribution<double> part(0.0, 1.0);
  // A cycle of another length each time: the fault meets the board's and the job's every phase.
  FaultRig rig(0.004 + 0.002 * part(random));
  rig.start(std::string(kJob));
  rig.run_for(0.98 * whole.time * part(random));
  REQUIRE(rig.state() == State::running);
  const double begin = rig.simulation.time();
  fault.strike(rig);
  const double stop = run_out(rig, fault, begin, outcome);
  const bool ended = !rig.shown()->job.ended_well;
  outcome.ended += ended ? 1 : 0;
  const bool is_wrong =
      (fault.fate == Fate::ends && !ended) || (fault.fate == Fate::goes_on && ended);
  outcome.wrong += is_wrong ? 1 : 0;
  if (ended) {
    outcome.slowest_stop = std::max(outcome.slowest_stop, stop);
    outcome.spindle_on += rig.bench().outputs().spindle_on ? 1 : 0;
  } else if (rig.truth() != whole.end) {
    ++outcome.elsewhere;
  }
  const AxisArray<Trust>& trust = rig.shown()->trust;
  const bool in_doubt =
      std::ranges::any_of(kLinearAxes, [&](Axis axis) { return trust[axis] != Trust::trusted; });
  outcome.in_doubt += in_doubt ? 1 : 0;
  outcome.claims_too_much += rig.trust_claims_too_much() ? 1 : 0;
}

}  // namespace

TEST_CASE("Any fault, at any instant of a job: the table of outcomes", "[LNK-4][STA-4][safety]") {
  FaultRig undisturbed(0.005);
  undisturbed.start(std::string(kJob));
  const double begin = undisturbed.simulation.time();
  REQUIRE(undisturbed.becomes(State::ready, 10.0));
  REQUIRE(undisturbed.shown()->job.ended_well);
  const Whole whole{undisturbed.truth(), undisturbed.simulation.time() - begin};
  fmt::print(
      "| fault | jobs ended | still after, s | spindle on | in doubt | trusted wrongly | "
      "mm inside the limits |\n|---|---:|---:|---:|---:|---:|---:|\n");
  for (const Fault& fault : kFaults) {
    INFO(fault.name);
    std::mt19937 random(1);
    Outcome outcome;
    for (int i = 0; i < kInstants; ++i) strike_once(fault, random, whole, outcome);
    fmt::print("| {} | {} | {:.3f} | {} | {} | {} | {:.1f} |\n", fault.name, outcome.ended,
               outcome.slowest_stop, outcome.spindle_on, outcome.in_doubt, outcome.claims_too_much,
               -outcome.beyond_limits);
    CHECK(outcome.wrong == 0);
    CHECK(outcome.still_moving == 0);
    CHECK(outcome.spindle_on == 0);
    CHECK(outcome.claims_too_much == 0);
    CHECK(outcome.elsewhere == 0);
    CHECK(outcome.beyond_limits <= 0.0);
  }
}
