// A ring of segments in order. Capacity is a power of two, so that the free-running indices may
// wrap. They are stored small: most of a board's memory is here.
#pragma once

#include <limits>

#include "hal/cpu5/firmware/segment.h"

namespace cnc::hal::cpu5::firmware {

template <std::uint32_t kCapacity>
class SegmentFifo {
  static_assert(kCapacity > 0 && (kCapacity & (kCapacity - 1)) == 0);

 public:
  [[nodiscard]] std::uint32_t size() const { return written_ - read_; }
  [[nodiscard]] std::uint32_t free() const { return kCapacity - size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }

  /// Not faster than kTopVelocity. False, and nothing stored, when full.
  bool push(const Segment& segment) {
    if (free() == 0) return false;
    ring_[written_++ % kCapacity] = stored(segment);
    return true;
  }

  /// Oldest segment. Not empty.
  Segment pop() { return whole(ring_[read_++ % kCapacity]); }

  /// Of those waiting, 0 is the oldest.
  [[nodiscard]] Segment operator[](std::uint32_t index) const {
    return whole(ring_[(read_ + index) % kCapacity]);
  }
  /// Leaves the oldest `count`, which wait.
  void cut(std::uint32_t count) { written_ = read_ + count; }
  void clear() { read_ = written_; }

 private:
  struct Stored {
    PerAxis<StepPosition> position;
    PerAxis<std::int32_t> velocity;
    std::uint32_t id;
    std::uint32_t duration : 31;
    std::uint32_t wait_for_index : 1;
    std::uint32_t spindle_period;
    OutputChange change;
  };
  static_assert(kTopVelocity <= std::numeric_limits<std::int32_t>::max());

  static Stored stored(const Segment& segment) {
    Stored result{.position = segment.position,
                  .velocity = {},
                  .id = segment.id,
                  .duration = segment.duration & 0x7FFFFFFFU,
                  .wait_for_index = segment.wait_for_index,
                  .spindle_period = segment.spindle_period,
                  .change = segment.change};
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      result.velocity[axis] = static_cast<std::int32_t>(segment.velocity[axis]);
    }
    return result;
  }

  static Segment whole(const Stored& stored) {
    Segment result{.id = stored.id,
                   .duration = stored.duration,
                   .position = stored.position,
                   .wait_for_index = stored.wait_for_index != 0,
                   .spindle_period = stored.spindle_period,
                   .change = stored.change};
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      result.velocity[axis] = stored.velocity[axis];
    }
    return result;
  }

  std::array<Stored, kCapacity> ring_{};
  std::uint32_t written_ = 0;
  std::uint32_t read_ = 0;
};

}  // namespace cnc::hal::cpu5::firmware
