// A ring of segments in order. Capacity is a power of two, so that the free-running indices may
// wrap.
#pragma once

#include "hal/cpu5/firmware/segment.h"

namespace cnc::hal::cpu5::firmware {

template <std::uint32_t kCapacity>
class SegmentFifo {
  static_assert(kCapacity > 0 && (kCapacity & (kCapacity - 1)) == 0);

 public:
  [[nodiscard]] std::uint32_t size() const { return written_ - read_; }
  [[nodiscard]] std::uint32_t free() const { return kCapacity - size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }

  /// False, and nothing stored, when full.
  bool push(const Segment& segment) {
    if (free() == 0) return false;
    ring_[written_++ % kCapacity] = segment;
    return true;
  }

  /// Oldest segment. Not empty.
  Segment pop() { return ring_[read_++ % kCapacity]; }

  /// Of those waiting, 0 is the oldest.
  [[nodiscard]] const Segment& operator[](std::uint32_t index) const {
    return ring_[(read_ + index) % kCapacity];
  }
  /// Leaves the oldest `count`, which wait.
  void cut(std::uint32_t count) { written_ = read_ + count; }
  void clear() { read_ = written_; }

 private:
  std::array<Segment, kCapacity> ring_{};
  std::uint32_t written_ = 0;
  std::uint32_t read_ = 0;
};

}  // namespace cnc::hal::cpu5::firmware
