#include "hal/cpu5/firmware/slice_player.h"

#include <limits>
#include <utility>

namespace cnc::hal::cpu5::firmware {

SlicePlayer::SlicePlayer(BoardIo& io) : io_(io), played_{.inputs = io.inputs(0)} {
  io_.set_outputs(outputs_);
}

// --- the step interrupt --------------------------------------------------------------------------

bool SlicePlayer::run_until(Ticks now) {
  ++runs_;
  const std::uint32_t first = read_;
  while (may_play()) {
    if (!entered_) enter_slice();
    make_steps(now);
    if (halted_ || front().end() > now) break;
    leave_slice();
  }
  played_.time = now;
  if (!entered_) sample_inputs(now);
  return !entered_ || halted_ || read_ != first;
}

Ticks SlicePlayer::next_due() const {
  if (!may_play()) return played_.time + kSliceTicks;
  const Slice& slice = front();
  if (!entered_) return slice.begin;
  const bool all_made = next_step_ == slice.step_count;
  return all_made ? slice.end() : slice.begin + slice.steps[next_step_].offset;
}

Ticks SlicePlayer::slice_end() const {
  return may_play() ? front().end() : std::numeric_limits<Ticks>::max();
}

void SlicePlayer::enter_slice() {
  const Slice& slice = front();
  entered_ = true;
  next_step_ = 0;
  played_.place = slice.from;
  sample_inputs(slice.begin);
  if (halted_) return;
  begun_ = read_ + 1;
  if (!outputs_held_) switch_begun();
}

void SlicePlayer::switch_begun() {
  for (; switched_ != begun_; ++switched_) {
    const OutputChange& change = ring_[switched_ % kSlices].change;
    if (change.empty()) continue;
    apply(change, outputs_);
    io_.set_outputs(outputs_);
  }
}

// The inputs are looked at behind the last step of a tick: nothing moves between the others.
void SlicePlayer::make_steps(Ticks now) {
  const Slice& slice = front();
  bool look = false;
  while (!halted_ && next_step_ < slice.step_count) {
    const TimedStep& step = slice.steps[next_step_];
    const Ticks due = slice.begin + step.offset;
    if (due > now) return;
    ++next_step_;
    played_.counts[step.axis] += step.direction;
    history_.note(step.axis, step.direction, due);
    io_.step(step.axis, step.direction, due);
    look = look || played_.probe_latch.armed || played_.home_latch[step.axis].armed;
    const bool more_at_once =
        next_step_ < slice.step_count && slice.steps[next_step_].offset == step.offset;
    if (!look || more_at_once) continue;
    sample_inputs(due);
    look = false;
  }
}

void SlicePlayer::leave_slice() {
  const Slice& slice = front();
  const bool goes_on = slice.goes_on;
  played_.place = slice.to;
  entered_ = false;
  ++read_;
  if (goes_on && idle()) raise(kFifoUnderrun);
}

void SlicePlayer::sample_inputs(Ticks now) {
  const std::uint32_t index_before = played_.inputs.index_count;
  played_.inputs = io_.inputs(now);
  if (played_.inputs.index_count != index_before) {
    played_.index_counts = history_.counts_at(played_.inputs.index_time, played_.counts);
  }
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if (played_.home_latch[axis].armed) watch_latch(axis, now);
  }
  if (played_.probe_latch.armed && played_.inputs.probe) watch_probe(now);
  watch_estop(now);
  watch_alarms();
}

void SlicePlayer::watch_latch(std::size_t axis, Ticks now) {
  const bool is_active = (played_.inputs.home & axis_bit(axis)) != 0;
  if (is_active == home_before_[axis]) return;
  home_before_[axis] = is_active;
  HomeLatch& latch = played_.home_latch[axis];
  if (is_active != (latch.edge == Edge::activate)) return;
  latch.armed = false;
  latch.caught = true;
  latch.count = played_.counts[axis];
  latch.time = now;
}

void SlicePlayer::watch_probe(Ticks now) {
  played_.probe_latch.armed = false;
  played_.probe_latch.caught = true;
  played_.probe_latch.counts = played_.counts;
  played_.probe_latch.time = now;
}

void SlicePlayer::watch_estop(Ticks now) {
  const bool was_active = std::exchange(estop_before_, played_.inputs.estop());
  if (!estop_before_) return;
  raise(kEstop);
  if (was_active) return;
  EstopLatch& latch = played_.estop_latch;
  latch = {.count = latch.count + 1, .counts = played_.counts, .time = now};
}

/// An alarm may last until the drives are switched off: only its beginning is a fault.
void SlicePlayer::watch_alarms() {
  const auto begun = static_cast<std::uint8_t>(played_.inputs.alarm &
                                               ~std::exchange(alarm_before_, played_.inputs.alarm));
  if (begun == 0) return;
  alarmed_axes_ |= begun;
  raise(kStepLoss);
}

void SlicePlayer::raise(FaultBits alarm) {
  alarms_ |= alarm;
  halted_ = true;
}

// --- the planning side ---------------------------------------------------------------------------

// Reads again when the interrupt came in between.
template <typename Read>
auto SlicePlayer::undisturbed(Read read) const {
  while (true) {
    const std::uint32_t before = runs_;
    std::atomic_signal_fence(std::memory_order_seq_cst);
    const auto result = read();
    std::atomic_signal_fence(std::memory_order_seq_cst);
    if (runs_ == before) return result;
  }
}

Ticks SlicePlayer::time() const {
  return undisturbed([this] { return played_.time; });
}

Ticks SlicePlayer::planned_until() const {
  return undisturbed(
      [this] { return idle() ? played_.time : ring_[(written_ - 1) % kSlices].end(); });
}

bool SlicePlayer::full() const {
  return undisturbed([this] {
    if (idle()) return false;
    const Ticks ahead = ring_[(written_ - 1) % kSlices].end() - front().begin;
    return ahead > 2 * kSliceTicks || written_ - read_ == kSlices;
  });
}

void SlicePlayer::commit() {
  std::atomic_signal_fence(std::memory_order_seq_cst);
  ++written_;
}

void SlicePlayer::drop() {
  halted_ = true;
  std::atomic_signal_fence(std::memory_order_seq_cst);
  played_.place = place_now();
  entered_ = false;
  read_ = begun_ = switched_ = written_.load();
  std::atomic_signal_fence(std::memory_order_seq_cst);
  halted_ = false;
}

template <typename Change>
void SlicePlayer::switch_outputs(Change change) {
  outputs_held_ = true;
  std::atomic_signal_fence(std::memory_order_seq_cst);
  change();
  io_.set_outputs(outputs_);
  std::atomic_signal_fence(std::memory_order_seq_cst);
  outputs_held_ = false;
  while (switched_ != begun_) {  // slices have begun meanwhile
    outputs_held_ = true;
    switch_begun();
    outputs_held_ = false;
  }
}

void SlicePlayer::set_outputs(const Outputs& outputs) {
  switch_outputs([&] { outputs_ = outputs; });
}

void SlicePlayer::change_outputs(const OutputChange& change) {
  switch_outputs([&] { apply(change, outputs_); });
}

Outputs SlicePlayer::outputs() const {
  return undisturbed([this] { return outputs_; });
}

void SlicePlayer::arm_latch(std::size_t axis, Edge edge) {
  HomeLatch& latch = played_.home_latch[axis];
  latch.armed = false;
  std::atomic_signal_fence(std::memory_order_seq_cst);
  latch = {.edge = edge};
  home_before_[axis] = (inputs_now().home & axis_bit(axis)) != 0;
  std::atomic_signal_fence(std::memory_order_seq_cst);
  latch.armed = true;
}

void SlicePlayer::arm_probe() {
  ProbeLatch& latch = played_.probe_latch;
  latch.armed = false;
  std::atomic_signal_fence(std::memory_order_seq_cst);
  latch = {.active_at_arming = inputs_now().probe};
  std::atomic_signal_fence(std::memory_order_seq_cst);
  latch.armed = !latch.active_at_arming;
}

Played SlicePlayer::played() const {
  return undisturbed([this] {
    Played result = played_;
    result.place = place_now();
    return result;
  });
}

// A slice may lead into the next segments; until it is over, its first one counts.
PathPlace SlicePlayer::place_now() const {
  PathPlace place = played_.place;
  if (!entered_) return place;
  const PathTime passed =
      (played_.time - front().begin) * (front().scale >> (kScaleBits - kPathFractionBits));
  const PathTime end = path_time(place.duration);
  place.elapsed = end - place.elapsed < passed ? end : place.elapsed + passed;
  return place;
}

}  // namespace cnc::hal::cpu5::firmware
