// Random bytes as the board's host and as the machine around it: whatever setups, frames, inputs
// and times come, the core neither crashes nor moves faster than its limit, nor moves at all while
// a fault is pending; what has to stop it does.
#include <memory>

#include "tests/fuzz/link_values.h"

namespace {

using cnc::fuzz::require;
using namespace cnc::hal::cpu5::firmware;

/// So many slices behind a change of the inputs what has to be noticed has been.
constexpr Ticks kNoticed = 2 * kSliceTicks;

/// Counts the pulses of every axis since the last check.
class FuzzedBoard final : public BoardIo {
 public:
  void step(std::size_t axis, int direction, Ticks when) override {
    require(axis < kAxisCount && (direction == 1 || direction == -1));
    require(when >= last_step_);
    last_step_ = when;
    ++pulses[axis];
  }
  Inputs inputs(Ticks) override { return present; }
  void set_outputs(const Outputs& outputs) override { last_outputs = outputs; }

  PerAxis<std::int64_t> pulses{};
  Inputs present{};
  Outputs last_outputs{};

 private:
  Ticks last_step_ = 0;
};

class Run {
 public:
  explicit Run(Bytes bytes) : bytes_(bytes) { set_up(); }

  void go() {
    while (!bytes_.empty()) {
      ask();
      check_state();
      const auto changes = bytes_.below(4);
      for (int i = 0; i < changes; ++i) vary(bytes_, board_.present, core_.time());
      pass(bytes_.flag() ? bytes_.next<std::uint16_t>() : bytes_.byte() * Ticks{10});
    }
  }

 private:
  void ask() {
    switch (bytes_.below(16)) {
      case 0:
        return set_up();
      case 1:
        return core_.host_left();
      case 2:
        return;  // a silent host
      default:
        frames_.fill(bytes_, *frame_, core_.status());
        execute(*frame_, core_);
    }
  }

  /// One that is refused changes nothing.
  void set_up() {
    const Setup setup = next_setup(bytes_);
    if (!core_.set_up(setup)) return;
    setup_ = setup;
    guard_acted_ = {};
    guard_counts_ = {};
  }

  /// Safe is: all off, but for drives if the setup leaves them on.
  void check_state() {
    const Status status = core_.status();
    const bool faulty = status.faults != 0;
    require(status.outputs == board_.last_outputs);
    require(!faulty || status.outputs == Outputs{.drives_enabled = status.outputs.drives_enabled});
    const bool drives_go_off = faulty && !was_faulty_ && setup_.drives_off_on_fault;
    require(!drives_go_off || !status.outputs.drives_enabled);
    was_faulty_ = faulty;
    require(!faulty || !status.moving);
    require(status.path_stop != PathStop::stopped || !status.moving);
    require(status.fifo_count + status.fifo_free == kFifoCapacity);
    require(status.queued_time >= 0);
  }

  void pass(Ticks ticks) {
    const bool faulty_before = core_.status().faults != 0;
    core_.advance(ticks);
    check_pulses(ticks, faulty_before);
    note_guards();
    alarm_noticed_ |= ticks < kNoticed ? board_.present.alarm : std::uint8_t{0};
    if (ticks >= kNoticed) check_watchers();
    check_state();
  }

  /// The way at the highest speed in that time; after an index pulse up to one slice may be owed,
  /// and rounding to whole steps is worth one more.
  void check_pulses(Ticks ticks, bool faulty_before) {
    const std::int64_t most = ((ticks + kSliceTicks) * setup_.max_velocity >> kFractionBits) + 2;
    for (std::int64_t& pulses : board_.pulses) {
      require(pulses <= (faulty_before ? 0 : most));
      pulses = 0;
    }
  }

  void note_guards() {
    const auto counts = core_.status().guard_counts;
    for (std::size_t i = 0; i < kGuardRules; ++i)
      guard_acted_[i] = guard_acted_[i] || counts[i] != guard_counts_[i];
    guard_counts_ = counts;
  }

  /// Nothing but the inputs tells what has to have been noticed.
  void check_watchers() {
    const Inputs& present = board_.present;
    const FaultBits faults = core_.status().faults;
    require(!present.estop() || (faults & kEstop) != 0);
    const auto begun = static_cast<std::uint8_t>(present.alarm & ~alarm_noticed_);
    require(begun == 0 || (faults & kStepLoss) != 0);
    alarm_noticed_ = present.alarm;
    for (std::size_t i = 0; i < kGuardRules; ++i) {
      require(!is_true(i) || guard_acted_[i]);
      guard_acted_[i] = guard_acted_[i] && is_true(i);
    }
  }
  [[nodiscard]] bool is_true(std::size_t i) const {
    const GuardRule& rule = setup_.guards[i];
    for (std::size_t bit = 0; bit < kCardInputs; ++bit) {
      if ((rule.participants >> bit & 1U) == 0) continue;
      const std::size_t port = kFirstCardPort + i / kRulesPerCard * kCardInputs + bit;
      if ((board_.present.ports >> port & 1U) != (rule.compare >> bit & 1U)) return false;
    }
    return rule.participants != 0 && rule.action != GuardAction::nothing;
  }

  Bytes bytes_;
  FuzzedBoard board_;
  Core core_{board_};
  Setup setup_{};
  FrameMaker frames_;
  std::unique_ptr<HostFrame> frame_ = std::make_unique<HostFrame>();
  PerGuardRule<bool> guard_acted_{};  // since it was seen to be untrue
  PerGuardRule<std::uint8_t> guard_counts_{};
  std::uint8_t alarm_noticed_ = 0;  // at the last moments, or may have been
  bool was_faulty_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Run({data, size}).go();
  return 0;
}
