// A button that another thread may press than the one that looks at it: the API's beside the
// link's.
#pragma once

#include <atomic>

namespace cnc::hal::sim {

class PushButton {
 public:
  PushButton() = default;
  PushButton(const PushButton& other) : pressed_(other.pressed()) {}

  void press(bool pressed) { pressed_.store(pressed, std::memory_order_relaxed); }
  [[nodiscard]] bool pressed() const { return pressed_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> pressed_{false};
};

}  // namespace cnc::hal::sim
