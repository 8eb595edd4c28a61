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
  /// A line of one of the files of a run; never 0.
  using Key = std::uint64_t;
  [[nodiscard]] static constexpr Key key_of(std::uint16_t file, std::uint32_t line) {
    return (Key{file} << 32U) | line;
  }

  /// The kept line, or nullptr.
  [[nodiscard]] const Line* find(Key key) const {
    const Slot& slot = slots_[key % kSlots];
    return slot.key == key ? slot.line.get() : nullptr;
  }
  /// Whether `number`, a line of the job outside of subs, has run before: the highest one so far
  /// tells, because only loops go back there.
  [[nodiscard]] bool has_run(std::uint32_t number) {
    if (number <= highest_) return true;
    highest_ = number;
    return false;
  }
  /// Where to parse a line that shall be kept; keep() makes it findable.
  [[nodiscard]] Line& slot_for(Key key) {
    Slot& slot = slots_[key % kSlots];
    slot.key = 0;
    if (!slot.line) slot.line = std::make_unique<Line>();
    return *slot.line;
  }
  void keep(Key key) { slots_[key % kSlots].key = key; }

  void clear() {
    if (highest_ == 0) return;
    for (Slot& slot : slots_) slot.key = 0;
    highest_ = 0;
  }

 private:
  static constexpr std::size_t kSlots = 1024;

  struct Slot {
    Key key = 0;
    std::unique_ptr<Line> line;
  };

  std::array<Slot, kSlots> slots_;
  std::uint32_t highest_ = 0;
};

}  // namespace cnc::interp
