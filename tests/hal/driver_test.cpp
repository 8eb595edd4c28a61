// The CPU5 driver in front of the virtual board, seen as a Controller.
#include <limits>

#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;
using cpu5::firmware::kFifoCapacity;

namespace {

constexpr auto kEstop = static_cast<Faults>(Fault::estop);
constexpr auto kUnderrun = static_cast<Faults>(Fault::fifo_underrun);
constexpr auto kBadSegment = static_cast<Faults>(Fault::bad_segment);
constexpr auto kLinkLost = static_cast<Faults>(Fault::link_lost);

std::unique_ptr<VirtualController> controller_at_zero() {
  return make_virtual_controller(small_machine(), {.machine = {.start = Position{}}});
}

}  // namespace

TEST_CASE("connect tells what the board can do", "[hal][LNK-2][LNK-3]") {
  const auto controller = controller_at_zero();
  CHECK(controller->free_segments() == 0);
  const auto capabilities = controller->connect();
  REQUIRE(capabilities);
  CHECK(capabilities->fifo_capacity == kFifoCapacity);
  CHECK(capabilities->max_step_frequency == 400e3);
  CHECK(capabilities->min_segment_duration == Approx(10e-6));
  CHECK(controller->free_segments() == kFifoCapacity);
}

TEST_CASE("A velocity that needs more steps than the board makes is an error at setup time",
          "[hal][LNK-3]") {
  config::MachineConfig config = small_machine();
  config.axes[Axis::Z].steps_per_unit = -8000.0;
  config.axes[Axis::Z].velocity = 50.1;  // 400.8 kHz
  const auto refused = make_virtual_controller(config)->connect();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::step_frequency_too_high);
  CHECK(refused.error().message.find("Axis Z") == 0);

  config.axes[Axis::Z].velocity = 50.0;
  CHECK(make_virtual_controller(config)->connect());
  CHECK_FALSE(
      make_virtual_controller(config, {.driver = {.max_step_frequency = 100e3}})->connect());
}

TEST_CASE("Steps per unit of zero are refused, naming the axis", "[hal]") {
  config::MachineConfig config = small_machine();
  config.axes[Axis::Y].steps_per_unit = 0.0;
  const auto refused = make_virtual_controller(config)->connect();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::axis_steps_per_unit_unusable);
  CHECK(refused.error().message.find("Axis Y") == 0);
}

TEST_CASE("A maximum step frequency that the board cannot make is refused", "[hal][LNK-3]") {
  // The board ends at 500 kHz; the driver asks for 1 % more than it uses.
  const auto connect = [](double frequency) {
    return make_virtual_controller(small_machine(), {.driver = {.max_step_frequency = frequency}})
        ->connect();
  };
  CHECK(connect(495e3));
  CHECK_FALSE(connect(496e3));
  CHECK_FALSE(connect(1e300));
  CHECK_FALSE(connect(0.0));
  CHECK_FALSE(connect(-1.0));
  CHECK_FALSE(connect(std::numeric_limits<double>::quiet_NaN()));
}

TEST_CASE("A segment moves the machine to its end, within half a step", "[hal][LNK-2]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  Segment segment{.id = 1, .duration = 0.1};
  segment.position[Axis::X] = 1.2337;   // 246.74 steps: 247
  segment.position[Axis::Y] = -0.9999;  // -199.98 steps: -200
  REQUIRE(controller->push({&segment, 1}) == 1);
  hand.status();
  hand.wait(0.05);
  CHECK(hand.status().moving);
  CHECK(hand.status().executing_id == 1);
  CHECK(hand.status().executing_phase == Approx(0.5));
  CHECK(hand.status().fifo_time == Approx(0.05));
  hand.wait(0.05);
  CHECK_FALSE(hand.status().moving);
  CHECK(hand.status().executing_phase == 1.0);
  CHECK(hand.status().position[Axis::X] == Approx(247 / 200.0));
  CHECK(hand.status().position[Axis::Y] == Approx(-200 / 200.0));
  CHECK(controller->machine().physical_position(Axis::X) == Approx(247 / 200.0));
  CHECK(hand.status().faults == 0);
}

TEST_CASE("An axis without a port is counted like the others, so a job does not notice", "[hal]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  hand.move(Axis::C, 3.0);
  CHECK(hand.status().position[Axis::C] == Approx(3.0));
  CHECK(controller->machine().physical_position(Axis::C) == 0.0);
}

TEST_CASE("push takes what fits and says how much", "[hal][LNK-2]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  std::vector<Segment> segments(kFifoCapacity + 50);
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    segments[i] = {.id = i + 1, .duration = 0.005};
    segments[i].position[Axis::X] = 0.02 * (i + 1);
  }
  CHECK(controller->push(segments) == kFifoCapacity);
  CHECK(controller->free_segments() == 0);
  CHECK(controller->push(segments) == 0);
  const ControllerStatus filled = hand.status();
  CHECK(filled.fifo_count == kFifoCapacity);
  CHECK(filled.fifo_time == Approx(kFifoCapacity * 0.005));
  hand.wait(0.0125);
  CHECK(controller->free_segments() == 3);
  CHECK(controller->push(std::span(segments).subspan(kFifoCapacity)) == 3);
  for (int i = 0; i < 53; ++i) hand.wait(0.1);  // 1027 segments take 5.135 s
  CHECK(hand.status().faults == 0);
  CHECK(hand.status().position[Axis::X] == Approx((kFifoCapacity + 3) * 0.02));
}

TEST_CASE("set_position renames the count exactly, also between two steps", "[hal][HOM-2]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  hand.move(Axis::X, 10.0);
  REQUIRE(controller->set_position(Axis::X, -12.3456));  // no multiple of 0.005 mm
  CHECK(hand.status().position[Axis::X] == Approx(-12.3456).margin(1e-12));
  CHECK(controller->machine().physical_position(Axis::X) == Approx(10.0));
  hand.move(Axis::X, 5.0);
  CHECK(hand.status().position[Axis::X] == Approx(-7.3456).margin(1e-12));
  CHECK(controller->machine().physical_position(Axis::X) == Approx(15.0));
}

TEST_CASE("set_position while moving is refused", "[hal]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  Segment segment{.id = 1, .duration = 0.1};
  segment.position[Axis::X] = 5.0;
  controller->push({&segment, 1});
  CHECK_FALSE(controller->set_position(Axis::X, 0.0));
  hand.status();
  hand.wait(0.05);
  CHECK_FALSE(controller->set_position(Axis::X, 0.0));
  hand.wait(0.05);
  CHECK(controller->set_position(Axis::X, 0.0));
}

TEST_CASE("An estop stops, switches off, and needs a release, a clear and new outputs",
          "[hal][STA-2][STA-4]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  controller->set_outputs({.drives_enabled = true, .spindle_on = true, .spindle_pwm = 0.5});
  CHECK(hand.status().outputs.spindle_pwm == 0.5);
  controller->machine().press_estop(true);
  hand.wait(0.001);
  CHECK(hand.status().faults == kEstop);
  CHECK(hand.status().inputs.estop1);
  CHECK(hand.status().outputs == Outputs{});
  CHECK(controller->free_segments() == 0);

  controller->clear_faults();
  CHECK(hand.status().faults == kEstop);
  controller->machine().press_estop(false);
  hand.wait(0.001);
  controller->clear_faults();
  CHECK(hand.status().faults == 0);
  CHECK_FALSE(controller->machine().outputs().spindle_on);

  controller->set_outputs({.drives_enabled = true});
  hand.move(Axis::X, 1.0);
  CHECK(controller->machine().physical_position(Axis::X) == Approx(1.0));
}

TEST_CASE("Clear, outputs and motion may be asked for in one exchange", "[hal][STA-2]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  Segment run{.id = 1, .duration = 0.1};
  run.position[Axis::X] = 2.5;
  run.velocity[Axis::X] = 50.0;
  controller->push({&run, 1});
  hand.status();
  hand.wait(0.2);
  REQUIRE(hand.status().faults == kUnderrun);
  Segment back{.id = 1, .duration = 0.1};
  controller->clear_faults();
  controller->set_outputs({.drives_enabled = true});
  CHECK(controller->push({&back, 1}) == 1);
  hand.status();
  hand.wait(0.1);
  CHECK(hand.status().faults == 0);
  CHECK(hand.status().position[Axis::X] == Approx(0.0).margin(1e-9));
}

TEST_CASE("Outputs asked for before a clear stay off", "[hal][STA-2]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  controller->machine().press_estop(true);
  hand.wait(0.001);
  controller->machine().press_estop(false);
  controller->set_outputs({.drives_enabled = true, .spindle_on = true});
  controller->clear_faults();
  CHECK(hand.status().faults == 0);
  CHECK(controller->machine().outputs() == cpu5::firmware::Outputs{});
}

TEST_CASE("quick_stop also drops what has not been sent yet", "[hal]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  Segment segment{.id = 1, .duration = 0.1};
  segment.position[Axis::X] = 5.0;
  controller->push({&segment, 1});
  controller->quick_stop();
  hand.status();
  hand.wait(1.0 / 3);
  CHECK(hand.status().position[Axis::X] == 0.0);
  CHECK(hand.status().faults == 0);
  CHECK(controller->push({&segment, 1}) == 1);
}

TEST_CASE("Numbers that are none are refused by the board, not executed", "[hal]") {
  const double value = GENERATE(std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity(), -1e300);
  const int where = GENERATE(0, 1, 2);
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  Segment segment{.id = 1, .duration = 0.1};
  if (where == 0) segment.duration = value;
  if (where == 1) segment.position[Axis::Z] = value;
  if (where == 2) segment.velocity[Axis::Z] = value;
  controller->push({&segment, 1});
  CHECK(hand.status().faults == kBadSegment);
  hand.wait(0.2);
  CHECK(hand.status().position == Position{});
}

TEST_CASE("A host that stays away too long has lost the link", "[hal][LNK-4]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  hand.wait(0.5);
  CHECK(hand.status().faults == 0);
  hand.wait(0.6);
  CHECK(hand.status().faults == kLinkLost);
  CHECK(hand.status().position == Position{});
}

TEST_CASE("After disconnect nothing is taken, and the counters are kept for the next connect",
          "[hal][LNK-4]") {
  const auto controller = controller_at_zero();
  Hand hand(*controller);
  hand.move(Axis::X, 3.0);
  controller->disconnect();
  CHECK_FALSE(hand.status().connected);
  const Segment segment{.id = 50, .duration = 0.1};
  CHECK(controller->push({&segment, 1}) == 0);
  REQUIRE(controller->connect());
  CHECK(hand.status().connected);
  CHECK(hand.status().position[Axis::X] == Approx(3.0));
}

TEST_CASE("The same job gives the same machine to the bit", "[hal]") {
  const auto end_of_job = [] {
    const auto controller = controller_at_zero();
    Hand hand(*controller);
    hand.move(Axis::X, 17.77);
    hand.move(Axis::Y, -33.1);
    return hand.status().position;
  };
  CHECK(end_of_job() == end_of_job());
}

namespace {

/// A board that takes everything and remembers what it was told.
struct Told {
  cpu5::firmware::Setup setup;
  std::vector<cpu5::firmware::HostFrame> frames;
  std::uint32_t window = 100;  ///< frames in one exchange
};

class Listener : public cpu5::BoardPort {
 public:
  explicit Listener(Told& told) : told_(told) {}
  Result<cpu5::wire::Identity> open(const cpu5::firmware::Setup& setup) override {
    told_.setup = setup;
    answer_.identity = {.max_step_frequency = 500'000, .fifo_capacity = 256};
    answer_.connected = true;
    answer_.greetings = 1;
    answer_.status.fifo_free = 256;
    return answer_.identity;
  }
  void close() override {}
  [[nodiscard]] std::uint32_t room() const override { return told_.window - in_exchange_; }
  void send(const cpu5::firmware::HostFrame& frame) override {
    told_.frames.push_back(frame);
    ++in_exchange_;
  }
  [[nodiscard]] std::uint64_t frames_sent() const override { return told_.frames.size(); }
  void quick_stop() override {}
  void receive(double) override {}
  const cpu5::BoardAnswer& exchange() override {
    in_exchange_ = 0;
    answer_.frames_done = told_.frames.size();
    return answer_;
  }

 private:
  Told& told_;
  std::uint32_t in_exchange_ = 0;
  cpu5::BoardAnswer answer_;
};

/// Segments of so many seconds that go on to the next with `velocity`.
void push(Controller& driver, int count, double duration, double velocity) {
  for (int i = 0; i < count; ++i) {
    static std::uint32_t id = 0;
    Segment segment{.id = ++id, .duration = duration};
    segment.velocity[Axis::X] = velocity;
    REQUIRE(driver.push({&segment, 1}) == 1);
  }
}

/// Of the frames of the last exchange those that go together with the next, as "+", others as "|".
std::string groups(Told& told, Controller& driver) {
  told.frames.clear();
  driver.exchange(0.0);
  std::string result;
  for (const auto& frame : told.frames) result += frame.with_next ? '+' : '|';
  return result;
}

}  // namespace

TEST_CASE("The pulses that the drives need are set up in the board", "[hal][LNK-3]") {
  config::MachineConfig config = small_machine();
  config.connection.pulse_width = 1.2;
  config.connection.direction_setup = 3.25;
  config.connection.direction_hold = 0.0;
  config.axes[Axis::X].step_active_low = true;
  config.axes[Axis::Z].step_active_low = true;
  config.axes[Axis::Y].direction_active_low = true;
  Told told;
  cpu5::Cpu5Driver driver(config, {}, std::make_unique<Listener>(told));
  REQUIRE(driver.connect());
  const cpu5::firmware::Setup& setup = told.setup;
  // Ticks of 0.1 µs; X is the lowest bit.
  CHECK(setup.pulse_width == 12);
  CHECK(setup.direction_setup == 33);
  CHECK(setup.direction_hold == 0);
  CHECK(setup.step_inverted == 0b101);
  CHECK(setup.direction_inverted == 0b010);
}

TEST_CASE("The start of a path goes together as far as it is short", "[hal][LNK-2][LNK-8][LNK-9]") {
  Told told;
  cpu5::Cpu5Driver driver(small_machine(), {}, std::make_unique<Listener>(told));
  REQUIRE(driver.connect());
  SECTION("until it lasts 50 ms: 3 frames of 13 segments, and 11 of the fourth") {
    push(driver, 80, 0.001, 1.0);
    CHECK(groups(told, driver) == "+++||||");
    SECTION("what follows a path that has begun is sent as it comes") {
      push(driver, 40, 0.001, 1.0);
      CHECK(groups(told, driver) == "||||");
    }
    SECTION("nor does it matter how a path ends") {
      push(driver, 20, 0.001, 1.0);
      push(driver, 20, 0.001, 0.0);
      CHECK(groups(told, driver) == "||||");
      push(driver, 40, 0.001, 1.0);
      CHECK(groups(told, driver) == "+++|");
    }
    SECTION("behind a cut it begins anew") {
      driver.cut_behind(40);
      push(driver, 40, 0.001, 1.0);
      CHECK(groups(told, driver) == "+++|");
    }
    SECTION("and behind a quick stop") {
      driver.quick_stop();
      push(driver, 40, 0.001, 1.0);
      CHECK(groups(told, driver) == "+++|");
    }
  }
  SECTION("segments of 5 ms need not") {
    push(driver, 40, 0.005, 1.0);
    CHECK(groups(told, driver) == "||||");
  }
  SECTION("a path that comes to rest is whole") {
    push(driver, 12, 0.001, 1.0);
    push(driver, 1, 0.001, 0.0);
    push(driver, 13, 0.001, 1.0);
    CHECK(groups(told, driver) == "||");
  }
  SECTION("never with a frame for which there is no room") {
    told.window = 2;
    push(driver, 40, 0.001, 1.0);
    CHECK(groups(told, driver) == "+|");
  }
}
