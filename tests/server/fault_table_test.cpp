// Every fault that a scenario can bring about, and pairs of them, at a hundred random instants of a
// job each, and some of homing, jog and probing: what becomes of what was going on, of the machine,
// of spindle and coolant, and of what is known of the position. Prints the tables. In virtual time,
// the same in every run.
#include <catch2/catch.hpp>
#include <fmt/core.h>
#include <limits>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

constexpr int kInstants = 100;

constexpr int kInstantsOfOthers = 25;  // of homing, jog, probing

// A cut with a rounded corner, a dwell, a thread at the spindle's pace, a way back and a probe
// move, from and to one place. X, Y and Z move, together and by themselves, to half a millimetre
// from the ends of their travel.
constexpr std::string_view kPlace = "G0 X20.5 Y20.5 Z-0.5";
constexpr std::string_view kJob =
    "HomeIsEstop on\n"
    "M3 S1200\nM8\n"
    "G91 G64 P0.5\n"
    "G1 X-20 F3000\nY-20\n"
    "G4 P0.2\n"
    "G33 Z10 K1\n"
    "G0 Z-10\n"
    "G1 X20 Z-2\nY20 Z2\n"
    "G38.2 Z-6 F600\n"
    "G90 G0 Z-0.5\n"
    "M30\n";

/// Where the tip of the tool touches: 3.5 mm below kPlace. Z stands at 0 at power-up, and at 10,
/// its home position, when it was homed there.
constexpr double kStock = -14.0;

class FaultRig : public Rig {
 public:
  /// `encoders`: the drives have them, and hold their position while they are off. `switches`: the
  /// axes are homed by them; else by hand.
  FaultRig(double period, bool encoders, bool switches = false)
      : Rig(shipped_machine(settings(encoders, switches)), options(period, switches)) {
    REQUIRE(reset());
    REQUIRE(home());
    REQUIRE(mdi(std::string(kPlace)));
    frame_ = bench().physical_position() - position();
    counted_from_ = position();
    counts_there_ = board().board().counts();
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

  /// Where the pulses have led, in the server's coordinates.
  Position pulsed() {
    const auto counts = board().board().counts();
    Position place = counted_from_;
    for (const Axis axis : kLinearAxes) {
      const std::size_t i = index_of(axis);
      place[axis] += static_cast<double>(counts[i] - counts_there_[i]) /
                     machine.config().axes[axis].steps_per_unit;
    }
    return place;
  }
  /// It counts from 0 again.
  void reset_board() {
    counted_from_ = pulsed();
    counts_there_ = {};
    board().board().reset();
  }

  /// How far pulses have led out of the limits, mm; below 0: inside. A motor that is stopped
  /// without a ramp may coast further.
  double beyond_limits() {
    double furthest = -std::numeric_limits<double>::infinity();
    for (const Axis axis : kLinearAxes) {
      const config::AxisConfig& limits = machine.config().axes[axis];
      const double at = pulsed()[axis];
      furthest = std::max({furthest, at - limits.positive_limit, limits.negative_limit - at});
    }
    return furthest;
  }

 private:
  static std::vector<std::string> settings(bool encoders, bool switches) {
    std::vector<std::string> settings{
        encoders ? "SAFETY.drivesHoldPosition=1" : "SAFETY.drivesHoldPosition=0",
        "SPINDLE_0.spindleRampUpTime=0.3",
        "GPIO_RULES.card_1_rule_1_inputParticipantBits=1",
        "GPIO_RULES.card_1_rule_1_inputCompareBits=1",
        "GPIO_RULES.card_1_rule_1_action=2",
        "GPIO_RULES.card_1_rule_2_inputParticipantBits=2",
        "GPIO_RULES.card_1_rule_2_inputCompareBits=2",
        "GPIO_RULES.card_1_rule_2_action=3"};
    for (const char axis : {'X', 'Y', 'Z'})
      if (!switches) settings.push_back(fmt::format("AXIS_{}.homeVelocity=0", axis));
    return settings;
  }
  /// An axis that comes fast to its home switch brakes behind its limit switch.
  static SimulationOptions options(double period, bool switches) {
    SimulationOptions options{.period = period};
    options.machine.start = Position{};
    options.machine.door = hal::sim::DoorOptions{.in_estop_chain = true};
    options.machine.touch.stock = [](double, double) { return kStock; };
    for (const Axis axis : kLinearAxes) {
      options.machine.axes[axis].motor.closed_loop = true;
      options.machine.axes[axis].limits_in_estop_chain = !switches;
    }
    return options;
  }

  Position frame_;
  Position counted_from_;
  hal::cpu5::firmware::PerAxis<std::int64_t> counts_there_{};
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
  int ends_at_least = 0;     ///< of a hundred jobs; where the fate depends on the instant
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
    Fault{"cable out for 0.16 s", Fate::goes_on, pull_cable, 0.16, plug_cable},
    Fault{"cable out for 0.22 s", Fate::may_end, pull_cable, 0.22, plug_cable},
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
          .strike = [](FaultRig& rig) { rig.reset_board(); },
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
    Fault{"home switch stuck off", Fate::goes_on,
          [](FaultRig& rig) {
            rig.bench().stick_switch(Axis::X, VirtualMotor::Switch::home, false);
          }},
    Fault{"limit switch stuck off", Fate::goes_on,
          [](FaultRig& rig) {
            rig.bench().stick_switch(Axis::Y, VirtualMotor::Switch::limit_low, false);
          }},
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
    // Up to the probe move it is refused; behind it nobody asks. The move is at the job's end.
    Fault{.name = "probe stuck",
          .fate = Fate::may_end,
          .strike = [](FaultRig& rig) { rig.bench().stick_probe(true); },
          .ends_at_least = 70},
    Fault{"probe stuck off", Fate::goes_on, [](FaultRig& rig) { rig.bench().stick_probe(false); }},
    Fault{"external error", Fate::goes_on,
          [](FaultRig& rig) { rig.bench().raise_external_error(true); }},
};

// A board that hears nothing waits for 0.2 s and then brakes, for 0.2 s at the most.
constexpr double kSilent = 0.2;
constexpr double kBraked = 0.4;

constexpr Fault fault_of(std::string_view name) {
  for (const Fault& row : kFaults)
    if (row.name == name) return row;
  throw "no such fault";  // does not compile
}

constexpr Fault kCableOut = fault_of("cable out for good");
constexpr Fault kCableLoose = fault_of("cable out for 0.16 s");
constexpr Fault kCableBack = fault_of("cable out for 0.3 s");
constexpr Fault kCableLate = fault_of("cable out for 1 s");
constexpr Fault kEstop = fault_of("emergency stop, channel 1");
constexpr Fault kReset = fault_of("board reset");
constexpr Fault kAlarm = fault_of("drive alarm");
constexpr Fault kGuardStop = fault_of("guard rule, smooth stop");
constexpr Fault kGuardQuickStop = fault_of("guard rule, quick stop");
constexpr Fault kStepsLost = fault_of("8 steps lost");
constexpr Fault kBusy = fault_of("server too busy for 0.4 s");
constexpr Fault kDoor = fault_of("door open");
constexpr Fault kHalfDeaf = fault_of("70 % lost");
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
double run_out(FaultRig& rig, std::vector<Deed> deeds, double longest, Outcome& outcome) {
  constexpr double kRest = 0.5;  // s
  std::ranges::sort(deeds, {}, &Deed::at);
  const double begin = deeds.front().at;
  double moved = begin;
  double worked = begin;
  Position last = rig.truth();
  auto next = deeds.begin();
  for (double now = rig.simulation.time(); now < begin + longest; now = rig.simulation.time()) {
    for (; next != deeds.end() && now >= next->at; ++next) next->act(rig);
    rig.simulation.cycle();
    if (rig.truth() != last) moved = now;
    if (rig.state() == State::running) worked = now;
    last = rig.truth();
    outcome.beyond_limits = std::max(outcome.beyond_limits, rig.beyond_limits());
    if (now > std::max({moved, worked, deeds.back().at}) + kRest) return moved - begin;
  }
  ++outcome.still_moving;
  return longest;
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
  // A spindle that gives no index is waited for, for 10 s.
  const double stop = run_out(rig, std::move(deeds), 20.0, outcome);
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
  fmt::print("\n{} instants each, {} cores\n", kInstants, std::thread::hardware_concurrency());
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
  CHECK(outcome.ended >= first.ends_at_least);
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

// --- homing, jog and probing ---------------------------------------------------------------------

namespace {

/// Something other than a job that moves the machine.
struct Activity {
  std::string_view name;
  bool switches;  ///< are needed
  void (*begin)(FaultRig&);
  double lasts;  ///< s; so long it is struck
  /// What ends it though it does not end a job, and the other way round.
  std::vector<std::pair<std::string_view, Fate>> fates;
  std::string_view cannot_know{};  ///< a fault by which an axis is homed at the wrong place
};

const Activity kActivities[] = {
    {.name = "homing",
     .switches = true,
     .begin = [](FaultRig& rig) { rig.machine.home({}, [](const Result<void>&) {}); },
     .lasts = 2.5,
     .fates = {{"home switch stuck", Fate::may_end},
               {"home switch stuck off", Fate::may_end},
               {"server too busy for 0.4 s", Fate::may_end},
               {"limit switch stuck", Fate::goes_on},
               {"probe stuck", Fate::goes_on}},
     // One that opens for good on the way off it opens for the machine where it should.
     .cannot_know = "home switch stuck off"},
    {.name = "jog",
     .switches = false,
     .begin =
         [](FaultRig& rig) {
           Position rates;
           rates[Axis::X] = 0.5;
           rates[Axis::Y] = 0.25;
           REQUIRE(rig.machine.jog(rates, 2.0));
         },
     .lasts = 1.8,
     .fates = {{"home switch stuck", Fate::goes_on}, {"probe stuck", Fate::goes_on}}},
    {.name = "probing",
     .switches = false,
     .begin = [](FaultRig& rig) { rig.start("G38.2 Z-10 F120\nM30\n"); },
     .lasts = 1.5,  // 3.5 mm at 2 mm/s
     .fates = {{"home switch stuck", Fate::goes_on}, {"probe stuck", Fate::goes_on}}},
};

/// All but those of cable and spindle.
constexpr std::array kOfOthers{
    "board reset",
    "server too busy for 0.4 s",
    "emergency stop, channel 1",
    "emergency stop, channel 2",
    "door open",
    "limit switch stuck",
    "home switch stuck",
    "home switch stuck off",
    "8 steps lost",
    "drive alarm",
    "guard rule, smooth stop",
    "guard rule, quick stop",
    "probe stuck",
    "probe stuck off",
    "external error",
};

void strike_activity(const Activity& activity, const Fault& fault, std::mt19937& random,
                     Outcome& outcome) {
  std::uniform_real_distribution<double> part(0.0, 1.0);
  FaultRig rig(0.004 + 0.002 * part(random), fault.encoders, activity.switches);
  activity.begin(rig);
  rig.run_for(activity.lasts * part(random));
  REQUIRE(rig.state() != State::ready);
  std::vector<Deed> deeds;
  plan(deeds, fault, rig.simulation.time());
  // A home switch has to release within half of the travel: 300 mm at 12.5 mm/s.
  const double stop = run_out(rig, std::move(deeds), 30.0, outcome);
  const auto of_activity =
      std::ranges::find(activity.fates, fault.name, &std::pair<std::string_view, Fate>::first);
  const Fate fate = of_activity != activity.fates.end() ? of_activity->second : fault.fate;
  const bool ended = rig.state() != State::ready;
  if (ended ? fate == Fate::goes_on : fate == Fate::ends) ++outcome.wrong;
  if (ended) outcome.slowest_stop = std::max(outcome.slowest_stop, stop);
  outcome.ended += ended ? 1 : 0;
  const AxisArray<Trust>& trust = rig.shown()->trust;
  outcome.in_doubt +=
      std::ranges::any_of(kLinearAxes, [&](Axis axis) { return trust[axis] != Trust::trusted; })
          ? 1
          : 0;
  outcome.claims_too_much += rig.trust_claims_too_much() ? 1 : 0;
}

}  // namespace

TEST_CASE("A fault while the machine is homed, jogged or probes: the table of outcomes",
          "[LNK-4][STA-4][HOM-2][safety]") {
  for (const Activity& activity : kActivities) {
    fmt::print(
        "\n| {}, {} instants each | ended | still after, s | in doubt | trusted wrongly |\n"
        "|---|---:|---:|---:|---:|\n",
        activity.name, kInstantsOfOthers);
    for (const char* name : kOfOthers) {
      CAPTURE(activity.name, name);
      const Fault fault = fault_of(name);
      std::mt19937 random(1);
      Outcome outcome;
      for (int i = 0; i < kInstantsOfOthers; ++i) strike_activity(activity, fault, random, outcome);
      fmt::print("| {} | {} | {:.3f} | {} | {} |\n", name, outcome.ended, outcome.slowest_stop,
                 outcome.in_doubt, outcome.claims_too_much);
      CHECK(outcome.wrong == 0);
      CHECK(outcome.still_moving == 0);
      if (activity.cannot_know != name) CHECK(outcome.claims_too_much == 0);
      if (fault.costs_trust) CHECK(outcome.in_doubt == kInstantsOfOthers);
      if (!activity.switches) CHECK(outcome.beyond_limits <= 0.0);
    }
  }
}
