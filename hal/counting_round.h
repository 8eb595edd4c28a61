// Numbers that count round.
#pragma once

#include <cstdint>

namespace cnc::hal {

/// `a` is newer if it is less than half the circle ahead.
[[nodiscard]] constexpr bool is_newer(std::uint32_t a, std::uint32_t b) {
  return a != b && a - b < (std::uint32_t{1} << 31);
}

/// Of segments, which leave 0 out.
[[nodiscard]] constexpr std::uint32_t id_after(std::uint32_t id) {
  return id + 1 == 0 ? 1 : id + 1;
}

}  // namespace cnc::hal
