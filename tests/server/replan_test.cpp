// Hold, resume, overrides and stop act on what the board has not begun (LNK-8, JOB-8, MAN-8):
// within 10 ms at a FifoTime of 0.25 s, along the same path, within the limits.
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <random>

#include "tests/server/recorded_motion.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

constexpr double kLongestLatency = 0.010;  // s; issue: MOT, LNK-8
constexpr double kSamePath = 2e-6;         // mm; each motion may be 1 nm beside the path
constexpr double kRounding = 1e-6;         // part of a limit

/// The link's cycle in cncserver.
constexpr double kPeriod = 0.002;

struct Case {
  const char* name;
  const char* program;
};

constexpr Case kCases[] = {
    {"a long line", "G1 X100 Y30 F4000\n"},
    {"a full circle", "G0 X10 Y40\nG2 X10 Y40 I20 J5 F5000\n"},
    {"lines and arcs, exact", "G61\nG1 X20 F4000\nG2 X30 Y10 J10\nG1 Y30\nG1 X0 Y0\n"},
    {"exact stops", "G61.1\nG1 X10 F3000\nX20\nX20 Y10\nX0 Y0\n"},
    {"a smoothed run",
     "G64 P0.1\nG1 X5 Y4 F5000\nX10 Y2\nX15 Y5\nX20 Y3\nX24 Y9\nX18 Y12\nX10 Y7\nX0 Y0\n"},
    {"rapids and feeds", "G0 X40\nG1 Y20 F2000\nG0 X0 Y0\n"},
    {"dwells", "G1 X10 F3000\nG4 P0.3\nG1 X20\nG4 P0.052\nG1 X0\n"},
};

struct FastRig : ReadyRig {
  explicit FastRig(std::vector<std::string> settings = {})
      : ReadyRig(free_machine(std::move(settings)), options()) {}
  static SimulationOptions options() {
    SimulationOptions options = at_zero();
    options.period = kPeriod;
    return options;
  }

  /// Starts and runs until `seconds` of the motion have been executed.
  void start_and_run(const RecordedMotion& motion, const std::string& program, double seconds) {
    start(program);
    REQUIRE(becomes([&] { return !motion.setpoints().empty(); }, 1.0));
    run_for(motion.begin() + seconds - simulation.time());
  }
  void run_to_end() { REQUIRE(becomes(State::ready)); }
  [[nodiscard]] std::string messages() const {
    std::string all;
    for (const LogMessage& message : simulation.log().after(0)) all += message.text + "; ";
    return all;
  }

  void require_well(const RecordedMotion& motion) {
    INFO(messages());
    CHECK(motion.usage(machine.config()) <= 1.0 + kRounding);
    for (const Axis axis : kLinearAxes) CHECK(simulation.virtual_machine().lost_steps(axis) == 0);
    CHECK(motion::norm(position() - motion.end()) < 0.01);  // half a step of each axis
  }
};

/// A board that executes a segment with such a number for somebody else: the machine goes on behind
/// it.
void number_on_behind(Rig& rig, std::uint32_t number) {
  hal::sim::VirtualController& board = rig.simulation.virtual_controller();
  const hal::Segment standing{
      .id = number, .duration = 0.001, .position = rig.simulation.link().status().board.position};
  REQUIRE(board.push({&standing, 1}) == 1);
  rig.run_for(0.1);
  board.trouble().cable_out = true;
  REQUIRE(rig.becomes(State::off, 2.0));
  board.trouble().cable_out = false;
  REQUIRE(rig.becomes(State::error, 5.0));
  REQUIRE(rig.reset());
  REQUIRE(rig.simulation.link().status().board.executing_id == number);
}

/// From the last status that the machine had seen when it was asked, to where the new path begins:
/// the request came after that.
double latency(const RecordedMotion& motion, double request) {
  return motion.end_of_kept() - (request - kPeriod);
}

/// The motion of an undisturbed run.
struct Reference {
  explicit Reference(const char* program) {
    rig.start(program);
    rig.run_to_end();
    INFO(rig.messages());
    REQUIRE(rig.shown()->job.ended_well);
  }
  FastRig rig;
  RecordedMotion motion{rig};
};

std::vector<double> random_instants(double duration, int count) {
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> spread(0.0, duration);
  std::vector<double> instants;
  for (int i = 0; i < count; ++i) instants.push_back(spread(engine));
  return instants;
}

double time_standing(const RecordedMotion& motion) {
  double time = 0.0;
  Position before;
  Position velocity;
  for (const motion::Setpoint& setpoint : motion.setpoints()) {
    const bool stands =
        setpoint.position == before && velocity == Position{} && setpoint.velocity == Position{};
    if (stands) time += setpoint.duration;
    before = setpoint.position;
    velocity = setpoint.velocity;
  }
  return time;
}

}  // namespace

TEST_CASE("A hold at any instant begins within 10 ms and stays on the path; resume ends the job",
          "[LNK-8][JOB-8][MOT-1]") {
  const Case& what = kCases[GENERATE(range(0, 7))];
  CAPTURE(what.name);
  const Reference reference(what.program);
  for (const double instant : random_instants(reference.motion.duration(), 12)) {
    CAPTURE(instant);
    FastRig rig;
    RecordedMotion motion(rig);
    rig.start_and_run(motion, what.program, instant);
    const double request = rig.simulation.time();
    rig.machine.pause([](const Result<void>&) {});
    if (motion.cuts() > 0) CHECK(latency(motion, request) <= kLongestLatency + 1e-9);
    REQUIRE(
        rig.becomes([&] { return rig.state() == State::paused || rig.state() == State::ready; }));
    CHECK(motion.cuts() <= 1);
    if (rig.state() == State::paused) {
      CHECK(motion.setpoints().back().velocity == Position{});
      REQUIRE(rig.machine.resume());
      rig.run_to_end();
    }
    CHECK(rig.shown()->job.ended_well);
    rig.require_well(motion);
    CHECK(motion.end() == reference.motion.end());
    CHECK(motion.distance_from(reference.motion) < kSamePath);
    CHECK(reference.motion.distance_from(motion) < kSamePath);
    CHECK(time_standing(motion) == Approx(time_standing(reference.motion)).margin(1e-9));
  }
}

TEST_CASE("A hold on a line brakes with the whole acceleration of its axis", "[LNK-8][JOB-8]") {
  FastRig rig;
  RecordedMotion motion(rig);
  const double a = rig.machine.config().axes[Axis::X].acceleration;
  rig.start_and_run(motion, "G1 X200 F3000\n", 1.5);
  REQUIRE(rig.pause());
  const double from = motion.setpoints()[motion.kept() - 1].position[Axis::X];
  // v²/2a, v = 50 mm/s.
  CHECK(motion.end()[Axis::X] - from == Approx(50.0 * 50.0 / (2.0 * a)).epsilon(1e-6));
}

TEST_CASE("A hold at an instant without motion ahead finds nothing to replace", "[LNK-8][JOB-8]") {
  const Reference reference("G1 X10 F3000\n");
  FastRig rig;
  RecordedMotion motion(rig);
  // The last 5 ms are as good as executed: two exchanges and a wake-up.
  rig.start_and_run(motion, "G1 X10 F3000\n", reference.motion.duration() - 0.004);
  rig.machine.pause([](const Result<void>&) {});
  CHECK(motion.cuts() == 0);
  REQUIRE(rig.becomes([&] { return rig.state() != State::pausing; }));
  CHECK(motion.end() == reference.motion.end());
}

TEST_CASE("Hold during hold, and stop while it brakes, leave the machine on the path at rest",
          "[LNK-8][JOB-8][JOB-5]") {
  const char* program = "G1 X100 Y30 F6000\n";
  const Reference reference(program);
  for (int ticks = 0; ticks < 40; ticks += 3) {
    CAPTURE(ticks);
    FastRig rig;
    RecordedMotion motion(rig);
    rig.start_and_run(motion, program, 0.5);
    rig.machine.pause([](const Result<void>&) {});
    for (int i = 0; i < ticks; ++i) rig.simulation.cycle();
    REQUIRE(rig.stop());
    CHECK(rig.state() == State::ready);
    CHECK(motion.setpoints().back().velocity == Position{});
    rig.require_well(motion);
    CHECK(motion.distance_from(reference.motion) < kSamePath);
  }
}

TEST_CASE("A stop at any tick of the link comes to rest on the path", "[LNK-8][JOB-5]") {
  const char* program =
      "G64 P0.05\nG1 X5 Y3 F4000\nX10 Y5\nG61\nX10 Y10\nG2 X20 Y20 I10\nG4 P0.05\nG1 X0\n";
  const Reference reference(program);
  for (double instant = 0.0; instant < reference.motion.duration(); instant += 0.014) {
    CAPTURE(instant);
    FastRig rig;
    RecordedMotion motion(rig);
    rig.start_and_run(motion, program, instant);
    const double request = rig.simulation.time();
    rig.machine.stop([](const Result<void>&) {});
    if (motion.cuts() > 0) CHECK(latency(motion, request) <= kLongestLatency + 1e-9);
    REQUIRE(rig.becomes(State::ready));
    CHECK(motion.setpoints().back().velocity == Position{});
    rig.require_well(motion);
    CHECK(motion.distance_from(reference.motion) < kSamePath);
  }
}

TEST_CASE("Overrides from 100 to 20 to 150 % act within 10 ms, on the same path",
          "[LNK-8][MAN-8]") {
  const Case& what = kCases[GENERATE(range(0, 7))];
  CAPTURE(what.name);
  const Reference reference(what.program);
  for (const double instant : random_instants(0.9 * reference.motion.duration(), 6)) {
    CAPTURE(instant);
    FastRig rig;
    RecordedMotion motion(rig);
    rig.start_and_run(motion, what.program, instant);
    for (const double factor : {0.2, 1.5}) {
      motion.forget_cuts();
      const double request = rig.simulation.time();
      REQUIRE(rig.machine.set_overrides({factor, std::min(factor, 1.0), 1.0}));
      if (motion.cuts() > 0) CHECK(latency(motion, request) <= kLongestLatency + 1e-9);
      rig.run_for(0.1);
    }
    rig.run_to_end();
    CHECK(rig.shown()->job.ended_well);
    rig.require_well(motion);
    CHECK(motion.end() == reference.motion.end());
    CHECK(motion.distance_from(reference.motion) < kSamePath);
    CHECK(reference.motion.distance_from(motion) < kSamePath);
    CHECK(time_standing(motion) == Approx(time_standing(reference.motion)).margin(1e-9));
  }
}

TEST_CASE("A lower override slows down as hard as the axis can, and then keeps the lower feed",
          "[LNK-8][MAN-8]") {
  FastRig rig;
  RecordedMotion motion(rig);
  const double a = rig.machine.config().axes[Axis::X].acceleration;
  rig.start_and_run(motion, "G1 X200 F3000\n", 1.5);
  REQUIRE(rig.machine.set_overrides({0.2, 1.0, 1.0}));
  rig.run_for(1.0);
  double braking = 0.0;
  std::size_t i = motion.kept();
  for (; motion.setpoints()[i].velocity[Axis::X] > 10.0 * (1.0 + 1e-9); ++i)
    braking += motion.setpoints()[i].duration;
  braking += motion.setpoints()[i].duration;
  CHECK(braking == Approx((50.0 - 10.0) / a).epsilon(0.01));
  CHECK(motion.setpoints()[i + 5].velocity[Axis::X] == Approx(10.0));
}

TEST_CASE("Overrides that change with every tick keep limits and path", "[LNK-8][MAN-8]") {
  const Case& what = kCases[GENERATE(range(0, 7))];
  CAPTURE(what.name);
  const Reference reference(what.program);
  FastRig rig;
  RecordedMotion motion(rig);
  rig.start(what.program);
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> spread(0.05, 3.0);
  for (int i = 0; i < 200 && rig.state() == State::running; ++i) {
    const double factor = spread(engine);
    REQUIRE(rig.machine.set_overrides({factor, std::min(factor, 1.0), 1.0}));
    rig.simulation.cycle();
  }
  REQUIRE(rig.machine.set_overrides({1.0, 1.0, 1.0}));
  rig.run_to_end();
  CHECK(rig.shown()->job.ended_well);
  rig.require_well(motion);
  CHECK(motion.end() == reference.motion.end());
  CHECK(motion.distance_from(reference.motion) < kSamePath);
}

TEST_CASE("A cut that comes too late changes nothing and is made again", "[LNK-8][JOB-8][safety]") {
  const Case& what = kCases[GENERATE(range(0, 7))];
  CAPTURE(what.name);
  const Reference reference(what.program);
  for (const double instant : random_instants(0.8 * reference.motion.duration(), 6)) {
    CAPTURE(instant);
    FastRig rig;
    RecordedMotion motion(rig);
    rig.start_and_run(motion, what.program, instant);
    rig.machine.pause([](const Result<void>&) {});
    // The link thread has not been woken for 50 ms.
    rig.simulation.link().cycle(rig.simulation.time() + 0.05);
    REQUIRE(
        rig.becomes([&] { return rig.state() == State::paused || rig.state() == State::ready; }));
    if (rig.state() == State::paused) REQUIRE(rig.machine.resume());
    rig.run_to_end();
    CHECK(rig.shown()->job.ended_well);
    rig.require_well(motion);
    CHECK(motion.end() == reference.motion.end());
    CHECK(motion.distance_from(reference.motion) < kSamePath);
    CHECK(reference.motion.distance_from(motion) < kSamePath);
    CHECK(time_standing(motion) == Approx(time_standing(reference.motion)).margin(1e-9));
  }
}

TEST_CASE("Messages and coolant of the part that is replaced come once, in order, at their place",
          "[LNK-8][JOB-8]") {
  const char* program =
      "G1 X2 F3000\n(MSG, first)\nX4\nM8\n(MSG, second)\nG4 P0.02\n(MSG, third)\nX6\n(MSG, "
      "fourth)\nX8\nM9\n"
      "(MSG, fifth)\nX10\n";
  const auto messages = [](const Rig& rig) {
    std::string all;
    for (const auto& message : rig.simulation.log().after(0))
      for (const char* word : {"first", "second", "third", "fourth", "fifth"})
        if (message.text.find(word) != std::string::npos) all += std::string(word) + " ";
    return all;
  };
  for (double instant = 0.0; instant < 0.5; instant += 0.025) {
    CAPTURE(instant);
    FastRig rig;
    RecordedMotion motion(rig);
    rig.start_and_run(motion, program, instant);
    const bool late = static_cast<int>(instant / 0.025) % 2 == 1;
    rig.machine.pause([](const Result<void>&) {});
    if (late) rig.simulation.link().cycle(rig.simulation.time() + 0.04);
    REQUIRE(
        rig.becomes([&] { return rig.state() == State::paused || rig.state() == State::ready; }));
    const double x = rig.position()[Axis::X];
    const std::string expected = x < 2.0   ? ""
                                 : x < 4.0 ? "first "
                                 : x < 6.0 ? "first second third "
                                           : "";
    if (x > 0.1 && x < 3.9 && std::abs(x - 2.0) > 0.1) CHECK(messages(rig) == expected);
    if (x > 4.1 && x < 5.9) CHECK(messages(rig) == expected);
    if (rig.state() == State::paused) REQUIRE(rig.machine.resume());
    rig.run_to_end();
    CHECK(messages(rig) == "first second third fourth fifth ");
    CHECK_FALSE(rig.shown()->flood);
  }
}

TEST_CASE("A released key, new rates and a lease that runs out act on a jog within 10 ms",
          "[LNK-8][MAN-1]") {
  Position rates;
  rates[Axis::X] = 1.0;
  rates[Axis::Y] = 0.5;
  for (int ticks = 20; ticks < 300; ticks += 7) {
    CAPTURE(ticks);
    FastRig rig;
    const double a = rig.machine.config().axes[Axis::X].acceleration;
    RecordedMotion motion(rig);
    REQUIRE(rig.machine.jog(rates, 10.0));
    for (int i = 0; i < ticks; ++i) rig.simulation.cycle();
    const double request = rig.simulation.time();
    const int what = ticks % 3;
    if (what == 0) rig.machine.jog_stop();
    if (what == 1) REQUIRE(rig.machine.jog(rates * -1.0, 10.0));
    if (what == 2) {
      REQUIRE(rig.machine.jog(rates, 10.0));  // says nothing new
      CHECK(motion.cuts() == 0);
      rig.machine.stop([](const Result<void>&) {});
    }
    CHECK(motion.cuts() == 1);
    CHECK(latency(motion, request) <= kLongestLatency + 1e-9);
    // From there on X brakes as hard as it can.
    const auto& all = motion.setpoints();
    const double before = all[motion.kept() - 1].velocity[Axis::X];
    const double change = before - all[motion.kept()].velocity[Axis::X];
    CHECK(change == Approx(std::min(before, a * all[motion.kept()].duration)).margin(1e-9));
    rig.machine.jog_stop();
    REQUIRE(rig.becomes(State::ready));
    CHECK(motion.setpoints().back().velocity == Position{});
    rig.require_well(motion);
  }
}

TEST_CASE("A jog whose cut comes too late stops none the less", "[LNK-8][MAN-1][safety]") {
  FastRig rig;
  RecordedMotion motion(rig);
  Position rates;
  rates[Axis::X] = 1.0;
  REQUIRE(rig.machine.jog(rates, 10.0));
  rig.run_for(0.5);
  rig.machine.jog_stop();
  // The link thread has not been woken for 20 ms.
  rig.simulation.link().cycle(rig.simulation.time() + 0.02);
  REQUIRE(rig.becomes(State::ready, 1.0));
  CHECK(motion.cuts() >= 3);  // the late one, its being revoked, the next
  CHECK(motion.setpoints().back().velocity == Position{});
  rig.require_well(motion);
}

TEST_CASE("A FIFO of two seconds of tiny moves is replaced like a short one", "[LNK-8][JOB-8]") {
  // A wave of chords of 0.05 mm: at 50 mm/s two seconds are 2000 of them.
  std::string program = GENERATE("G61\nG0 X0 Y20\nG1 F3000\n", "G64 P0.01\nG0 X0 Y20\nG1 F3000\n");
  for (int i = 1; i <= 6000; ++i)
    program += fmt::format("X{:.4f} Y{:.4f}\n", 0.05 * i, 20.0 + 5.0 * std::sin(0.01 * i));
  const std::vector<std::string> settings{"TRAJECTORY.fifoTime=2"};
  FastRig undisturbed(settings);
  const RecordedMotion reference(undisturbed);
  undisturbed.start(program);
  undisturbed.run_to_end();
  FastRig rig(settings);
  RecordedMotion motion(rig);
  rig.start_and_run(motion, program, 3.0);
  CHECK(motion.duration() > 4.9);
  for (int round = 0; round < 4; ++round) {
    motion.forget_cuts();
    const double request = rig.simulation.time();
    rig.machine.pause([](const Result<void>&) {});
    CHECK(motion.cuts() == 1);
    CHECK(latency(motion, request) <= kLongestLatency + 1e-9);
    const bool pauses = rig.becomes(State::paused, 0.5);
    INFO(rig.messages());
    REQUIRE(pauses);
    REQUIRE(rig.machine.resume());
    rig.run_for(0.3);
    REQUIRE(rig.machine.set_overrides({round % 2 == 0 ? 1.5 : 0.5, 1.0, 1.0}));
    rig.run_for(0.1);
  }
  rig.run_to_end();
  CHECK(rig.shown()->job.ended_well);
  rig.require_well(motion);
  CHECK(motion.end() == reference.end());
  // A setpoint joins several of these moves and meets the path to 1 nm where they end.
  CHECK(motion.distance_from(reference) < 1e-5);
}

TEST_CASE("Holds, cuts and notes are the same where the segments' numbers go round",
          "[LNK-8][JOB-8]") {
  // X and Y run for more than a second, in segments of 5 ms: 50 of them are under way.
  const char* program =
      "G1 X10 F2000\nM8\nG1 X20\nM9\nG64 P0.1\nG1 X30 Y5\nX20 Y10\nX10 Y5\nX0 Y0\n";
  Reference reference(program);
  const double flooded = reference.rig.simulation.virtual_machine().flood_time();
  REQUIRE(flooded > 0.1);
  for (const std::uint32_t left : {0U, 1U, 30U, 60U, 100U, 130U, 200U, 260U}) {
    CAPTURE(left);
    FastRig rig;
    number_on_behind(rig, 0xFFFF'FFFFU - left);
    RecordedMotion motion(rig);
    rig.start_and_run(motion, program, 0.5);
    REQUIRE(rig.pause());
    CHECK(motion.cuts() == 1);
    REQUIRE(rig.machine.resume());
    REQUIRE(rig.becomes([&] { return rig.state() == State::running; }));
    rig.run_for(0.2);
    REQUIRE(rig.machine.set_overrides({0.5, 1.0, 1.0}));
    REQUIRE(rig.machine.set_overrides({1.0, 1.0, 1.0}));
    rig.run_to_end();
    CHECK(rig.simulation.link().status().board.executing_id < 2000);
    CHECK(rig.shown()->job.ended_well);
    rig.require_well(motion);
    CHECK(motion.end() == reference.motion.end());
    CHECK(motion.distance_from(reference.motion) < kSamePath);
    CHECK(rig.simulation.virtual_machine().flood_time() > 0.9 * flooded);
    CHECK_FALSE(rig.simulation.virtual_machine().outputs().flood);
  }
}
