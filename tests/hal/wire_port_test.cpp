// A job over a line that loses, delays, doubles, reorders and damages packets: the same steps.
#include <catch2/catch.hpp>

#include "tests/hal/machine_support.h"

namespace cnc::hal::sim {

namespace {

/// X to and fro by `count` segments of 5 ms, from rest to rest, kept a quarter of a second ahead.
class Shuttle {
 public:
  explicit Shuttle(VirtualController& controller) : controller_(controller) {
    REQUIRE(controller_.connect());
    controller_.set_outputs({.drives_enabled = true});
  }

  /// One millisecond of the link's life.
  const ControllerStatus& cycle() {
    now_ += 0.001;
    const ControllerStatus& status = controller_.exchange(now_);
    // The FIFO is filled while the first segments move already.
    const bool filled = status.executing_id > 50 && next_ <= last_;
    if (filled) lowest_fifo_time_ = std::min(lowest_fifo_time_, status.fifo_time);
    return status;
  }
  void feed() {
    while (next_ <= last_ && status().fifo_time + on_their_way() < 0.25) {
      const Segment segment = segment_number(next_);
      if (controller_.push({&segment, 1}) != 1) return;
      ++next_;
    }
  }
  void run(std::uint32_t count, double patience = 60.0) {
    last_ = next_ + count - 1;
    const double until = now_ + patience;
    do {
      feed();
      cycle();
      REQUIRE(status().faults == 0);
      REQUIRE(now_ < until);
    } while (next_ <= last_ || status().executing_id != last_ || status().moving);
  }

  [[nodiscard]] const ControllerStatus& status() { return controller_.exchange(now_); }
  [[nodiscard]] double lowest_fifo_time() const { return lowest_fifo_time_; }
  [[nodiscard]] double now() const { return now_; }

 private:
  // A sine of 0.5 s, 10 mm to either side.
  [[nodiscard]] static Segment segment_number(std::uint32_t number) {
    const double angle = 2.0 * M_PI * number / 100.0;
    Segment segment{.id = number, .duration = 0.005};
    segment.position[Axis::X] = 10.0 * (1.0 - std::cos(angle));
    segment.velocity[Axis::X] = 10.0 * 2.0 * M_PI / 0.5 * std::sin(angle);
    if (number % 50 == 0) segment.velocity[Axis::X] = 0.0;
    return segment;
  }
  [[nodiscard]] double on_their_way() {
    const std::uint32_t known = status().executing_id + status().fifo_count;
    return next_ - 1 > known ? 0.005 * (next_ - 1 - known) : 0.0;
  }

  VirtualController& controller_;
  double now_ = 0.0;
  std::uint32_t next_ = 1;
  std::uint32_t last_ = 0;
  double lowest_fifo_time_ = 1.0;
};

SimOptions at_zero() { return {.machine = {.start = Position{}}}; }

}  // namespace

TEST_CASE("A line in trouble costs time but no step", "[hal][LNK-9][LNK-4]") {
  struct Row {
    const char* name;
    LinkTrouble trouble;
  };
  static const Row kRows[]{
      {"none", {}},
      {"5 % lost, 20 ms of jitter", {.loss = 0.05, .jitter = 0.02}},
      {"30 % lost", {.loss = 0.3}},
      {"everything doubled and late", {.duplication = 1.0, .delay = 0.01, .jitter = 0.01}},
      {"one in ten damaged", {.corruption = 0.1, .jitter = 0.005}},
      {"all at once",
       {.loss = 0.1, .duplication = 0.1, .corruption = 0.05, .delay = 0.005, .jitter = 0.02}},
  };
  const Row& row = kRows[GENERATE(range(0, 6))];
  CAPTURE(row.name);
  const auto controller = make_virtual_controller(small_machine(), at_zero());
  Shuttle shuttle(*controller);
  controller->trouble() = row.trouble;
  shuttle.run(2000);
  CHECK(controller->machine().physical_position(Axis::X) == Approx(0.0).margin(1e-9));
  CHECK(shuttle.status().position[Axis::X] == Approx(0.0).margin(1e-9));
  CHECK(controller->machine().lost_steps(Axis::X) == 0);
  CHECK(shuttle.status().executing_id == 2000);
  CHECK(shuttle.lowest_fifo_time() > 0.05);
}

TEST_CASE("Requests are done when the board has answered them", "[hal][LNK-9]") {
  const auto controller = make_virtual_controller(small_machine(), at_zero());
  Shuttle shuttle(*controller);
  controller->trouble().delay = 0.01;
  shuttle.cycle();
  controller->set_outputs({.drives_enabled = true, .flood = true});
  const std::uint64_t frame = controller->next_frame();
  int cycles = 0;
  for (; shuttle.cycle().frames_done < frame; ++cycles) {
    CHECK_FALSE(shuttle.status().outputs.flood);
    REQUIRE(cycles < 100);
  }
  CHECK(shuttle.status().outputs.flood);
  CHECK(cycles >= 19);  // there and back
}

TEST_CASE("Every packet is counted once, by what came of it", "[hal][LNK-9]") {
  const auto controller = make_virtual_controller(small_machine(), at_zero());
  Shuttle shuttle(*controller);
  shuttle.run(100);
  CHECK(std::string(controller->exchange(shuttle.now()).board.name.data()) == "virtual board");
  CHECK(shuttle.status().board.serial == 1);
  PacketCounts counts = shuttle.status().packets;
  CHECK(counts.sent == counts.answered);  // in memory each is answered at once
  CHECK(counts.resent == 0);
  CHECK(counts.passed_over + counts.corrupted == 0);

  controller->trouble().duplication = 1.0;  // the second of each pair brings nothing new
  shuttle.run(100);
  CHECK(shuttle.status().packets.passed_over > 0);
  CHECK(shuttle.status().packets.corrupted == 0);

  controller->trouble() = {.corruption = 0.2, .delay = 0.004};
  shuttle.run(100);
  CHECK(shuttle.status().packets.corrupted > 0);
  CHECK(shuttle.status().packets.resent > 0);
  CHECK(shuttle.status().round_trip == Approx(0.008).margin(0.0015));  // there and back
}

TEST_CASE("A cable that is out is noticed, and one that is back in is used again",
          "[hal][LNK-9][LNK-4]") {
  const auto controller = make_virtual_controller(small_machine(), at_zero());
  Shuttle shuttle(*controller);
  shuttle.run(150);
  const double there = shuttle.status().position[Axis::X];
  CHECK(shuttle.status().sessions == 1);
  controller->trouble().cable_out = true;
  for (int i = 0; i < 240; ++i) CHECK(shuttle.cycle().connected);
  for (int i = 0; i < 20; ++i) shuttle.cycle();
  CHECK_FALSE(shuttle.status().connected);
  Segment segment{.id = 151, .duration = 0.01};
  CHECK(controller->push({&segment, 1}) == 0);
  for (int i = 0; i < 1500; ++i) shuttle.cycle();

  controller->trouble().cable_out = false;
  for (int i = 0; i < 200; ++i) shuttle.cycle();
  const ControllerStatus& back = shuttle.status();
  CHECK(back.connected);
  CHECK(back.sessions == 2);
  CHECK_FALSE(back.counts_lost);
  CHECK(back.position[Axis::X] == Approx(there));
  CHECK((back.faults & static_cast<Faults>(Fault::link_lost)) != 0);
}

TEST_CASE("What was asked for without a link does not count behind it", "[hal][LNK-9][LNK-4]") {
  const auto controller = make_virtual_controller(small_machine(), at_zero());
  Shuttle shuttle(*controller);
  shuttle.cycle();
  controller->trouble().cable_out = true;
  for (int i = 0; i < 1000; ++i) shuttle.cycle();
  REQUIRE_FALSE(shuttle.status().connected);
  controller->clear_faults();
  controller->arm_home_latch(Axis::X, LatchEdge::activate);
  controller->arm_probe_latch();
  controller->trouble().cable_out = false;
  for (int i = 0; i < 200; ++i) shuttle.cycle();
  REQUIRE(shuttle.status().connected);
  CHECK(shuttle.status().faults == static_cast<Faults>(Fault::link_lost));
  CHECK(controller->free_segments() == 0);
  CHECK_FALSE(shuttle.status().home_latch[Axis::X].armed);
  CHECK_FALSE(shuttle.status().probe_latch.armed);
}

TEST_CASE("Lost counts are told however the line fails while the board is greeted",
          "[hal][LNK-9][LNK-4][safety]") {
  const int cycles = GENERATE(range(0, 150, 3));
  INFO("cable out " << cycles << " ms after the reset");
  const auto controller = make_virtual_controller(small_machine(), at_zero());
  Shuttle shuttle(*controller);
  controller->trouble().delay = 0.007;  // greeting and first status are apart
  bool told = false;
  const auto pass = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const ControllerStatus& status = shuttle.cycle();
      told = told || (status.connected && status.counts_lost);
    }
  };
  pass(50);
  controller->board().reset();
  pass(cycles);
  controller->trouble().cable_out = true;
  pass(400);
  controller->trouble().cable_out = false;
  pass(1500);  // the board keeps a host that is silent for a second
  CHECK(shuttle.status().connected);
  CHECK(told);
}

TEST_CASE("A board that was reset is greeted again, and its counts are known to be lost",
          "[hal][LNK-9][LNK-4]") {
  const auto controller = make_virtual_controller(small_machine(), at_zero());
  Shuttle shuttle(*controller);
  shuttle.run(150);
  const double there = shuttle.status().position[Axis::X];
  REQUIRE(there > 1.0);
  controller->board().reset();
  for (int i = 0; i < 200; ++i) shuttle.cycle();
  CHECK(shuttle.status().connected);
  CHECK(shuttle.status().sessions == 2);
  CHECK(shuttle.status().counts_lost);
  CHECK(shuttle.status().position[Axis::X] == Approx(there));
}

TEST_CASE("A board that does not answer is an error that says so", "[hal][LNK-1]") {
  const auto controller = make_virtual_controller(small_machine(), at_zero());
  controller->trouble().cable_out = true;
  const auto refused = controller->connect();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::board_silent);
  // It goes on trying.
  controller->trouble().cable_out = false;
  double now = 0.0;
  for (int i = 0; i < 300 && !controller->exchange(now).connected; ++i) now += 0.001;
  CHECK(controller->exchange(now).connected);
  CHECK(controller->free_segments() == cpu5::firmware::kFifoCapacity);
}

}  // namespace cnc::hal::sim
