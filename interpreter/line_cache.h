// Parsed lines that run more than once: loops and subs are parsed once and evaluated often.
//
// Lines of subs are kept from their first run, others from their second, so a program without loops
// and subs never fills the cache. Bounded: a line shares its slot with every 1024th other line, and
// the one that runs takes it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "interpreter/line.h"

namespace cnc::interp {

class LineCache {
 public:
  /// The kept line, or nullptr.
  [[nodiscard]] const Line* find(std::uint32_t number) const {
    const Slot& slot = slots_[number % kSlots];
    return number != 0 && slot.number == number ? slot.line.get() : nullptr;
  }
  /// Whether `number`, a line outside of subs, has run before: the highest one so far tells,
  /// because only loops go back there.
  [[nodiscard]] bool has_run(std::uint32_t number) {
    if (number <= highest_) return true;
    highest_ = number;
    return false;
  }
  /// Where to parse a line that shall be kept; keep() makes it findable.
  [[nodiscard]] Line& slot_for(std::uint32_t number) {
    Slot& slot = slots_[number % kSlots];
    slot.number = 0;
    if (!slot.line) slot.line = std::make_unique<Line>();
    return *slot.line;
  }
  void keep(std::uint32_t number) { slots_[number % kSlots].number = number; }

  void clear() {
    if (highest_ == 0) return;
    for (Slot& slot : slots_) slot.number = 0;
    highest_ = 0;
  }

 private:
  static constexpr std::size_t kSlots = 1024;

  struct Slot {
    std::uint32_t number = 0;
    std::unique_ptr<Line> line;
  };

  std::array<Slot, kSlots> slots_;
  std::uint32_t highest_ = 0;
};

}  // namespace cnc::interp
