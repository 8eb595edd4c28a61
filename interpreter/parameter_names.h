// Named parameters, #<depth> and #<_depth>: an extension that programs for LinuxCNC rely on.
//
// Upper and lower case are the same, blanks mean nothing. A name that begins with "_" is one value
// for everybody, as long as the interpreter lives. Every other name belongs to one call of a sub,
// or to the program outside of subs, and is forgotten with it. A name has no value until one is
// set.
//
// Names are numbers from kFirstId on behind the parser, so that settings of both kinds go the same
// way and the numbered parameters pay nothing for them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "interpreter/refusal.h"

namespace cnc::interp {

class ParameterNames {
 public:
  static constexpr std::int32_t kFirstId = 10'000;
  static constexpr std::size_t kMaxNames = 10'000;

  [[nodiscard]] static constexpr bool is_name(std::int32_t number) { return number >= kFirstId; }

  /// The id of a name as it stands between "<" and ">"; a new one if need be.
  [[nodiscard]] Parsed<std::int32_t> id_of(std::string_view written, Span span);
  [[nodiscard]] const std::string& name_of(std::int32_t id) const { return entry(id).name; }

  [[nodiscard]] std::optional<double> find(std::int32_t id) const;
  void set(std::int32_t id, double value);

  void enter_sub();
  void leave_sub();
  /// The program is over: local names and their ids are gone.
  void forget_locals();

 private:
  /// Depth of calls; 1 outside of subs.
  using Depth = std::uint32_t;
  static constexpr Depth kUnset = 0;
  static constexpr Depth kOutside = 1;

  struct Entry {
    std::string name;
    bool is_global = false;
    double value = 0.0;
    Depth set_at = kUnset;  ///< the call that the value belongs to; of a global any but kUnset
  };
  /// What a call has covered, to be put back when it returns.
  struct Covered {
    std::size_t index;
    double value;
    Depth set_at;
  };

  [[nodiscard]] static std::size_t index(std::int32_t id) {
    return static_cast<std::size_t>(id - kFirstId);
  }
  [[nodiscard]] const Entry& entry(std::int32_t id) const { return entries_.at(index(id)); }

  std::vector<Entry> entries_;
  std::unordered_map<std::string, std::int32_t> ids_;
  std::vector<Covered> covered_;
  std::vector<std::size_t> calls_;  ///< size of covered_ when each of them began
  Depth depth_ = kOutside;
};

}  // namespace cnc::interp
