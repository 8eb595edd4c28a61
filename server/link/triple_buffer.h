// One writer, one reader, the newest value, and neither ever waits for the other.
//
// Three slots: one that the writer fills, one that the reader looks at, and one in the middle that
// they swap with an atomic exchange.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace cnc::server {

template <typename T>
class TripleBuffer {
 public:
  /// Writer's thread: the slot to fill; publish() hands it over.
  [[nodiscard]] T& back() { return slots_[back_]; }
  void publish() {
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) &
            kIndex;
  }

  /// Reader's thread: the newest published value; stays valid until the next call.
  [[nodiscard]] const T& read() {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0)
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return slots_[front_];
  }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;

  std::array<T, 3> slots_{};
  std::atomic<std::uint8_t> middle_{1};
  std::uint8_t back_ = 0;
  std::uint8_t front_ = 2;
};

}  // namespace cnc::server
