// Where the if, while and sub lines of a program are and which belong together. Built in the one
// pass that finds the lines, by looking at the first letters of each line only, so that loops and
// subs work in a file of any size.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "interpreter/line.h"

namespace cnc::interp {

struct FlowMark {
  static constexpr std::uint32_t kNoPartner = 0xFFFF'FFFF;

  std::uint64_t offset = 0;            ///< of the line in the text
  std::uint32_t line = 0;              ///< from 1
  std::uint32_t partner = kNoPartner;  ///< index of the mark to go to; see partner_of()
  Statement statement{};
};

class FlowIndex {
 public:
  /// More marks than any program written by hand or machine; bounds the memory.
  static constexpr std::size_t kMaxMarks = 1'000'000;

  /// Called for every line in order; remembers those that steer the program. False when full.
  bool look_at(std::string_view text, std::uint32_t line, std::uint64_t offset);

  /// The mark of `line`, which steers the program.
  [[nodiscard]] const FlowMark* find(std::uint32_t line) const;
  /// Where control goes from a mark: if to its else or endif, else to endif, while to endwhile and
  /// back, sub to endsub. nullptr when the program has no such line.
  [[nodiscard]] const FlowMark* partner_of(const FlowMark& mark) const;

  struct Sub {
    const FlowMark* mark = nullptr;
    std::uint32_t other_line = 0;  ///< of a second sub with this name, 0 if there is none
  };
  [[nodiscard]] Sub find_sub(std::string_view name) const;

 private:
  struct SubEntry {
    std::uint32_t index;
    std::uint32_t other_line = 0;
  };

  void match(std::uint32_t index);
  /// Makes `index` the partner of the innermost open mark if that is an `opener`.
  [[nodiscard]] bool close(std::uint32_t index, Statement opener);
  void add_sub(std::string_view name, std::uint32_t index);

  std::vector<FlowMark> marks_;
  std::vector<std::uint32_t> open_;                 ///< marks that wait for their partner
  std::unordered_map<std::string, SubEntry> subs_;  ///< by upper-case name
};

}  // namespace cnc::interp
