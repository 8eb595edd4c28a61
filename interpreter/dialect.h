// Which G-code a program is written in: tables and a few rules, so that nothing else asks.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "interpreter/code_table.h"

namespace cnc::interp {

enum class DialectId : std::uint8_t {
  eding,  ///< RS274/NGC with the extensions of the Eding CNC 4.01 manual
  pscnc,  ///< the codes of the PSCNC manual, section 3.3
};

struct Dialect {
  std::string_view name;
  std::span<const Code> g_codes;
  std::span<const Code> m_codes;
  const Code* (*find_g_code)(std::int32_t ten_times_number);
  const Code* (*find_m_code)(std::int32_t number);
  std::uint8_t max_m_codes;          ///< on a line
  bool ignores_unknown_g;            ///< with a warning
  bool short_radius_is_half_circle;  ///< R below half the distance: 180 degrees instead of an error
  bool radius_is_positive;           ///< no negative R for arcs above 180 degrees
  bool circle_needs_end;             ///< "G2 I5": a full circle, with a warning
  bool needs_end;                    ///< the last line of a program is M0 or M30
  bool has_names;                    ///< #<name>: an extension
};

[[nodiscard]] const Dialect& dialect(DialectId id);

}  // namespace cnc::interp
