// Why there is no link to the board: in numbers, because the link thread makes no text.
#pragma once

#include <cstdint>
#include <string_view>

#include "config/error.h"

namespace cnc::hal {

struct LinkObstacle {
  enum class Kind : std::uint8_t {
    none,            ///< or nothing is known yet, or the way to the board itself is not open
    silent,          ///< nobody answers
    busy,            ///< it has another host, or is moving
    other_version,   ///< of the protocol
    bad_setup,       ///< a value of the setup is out of its range
    not_understood,  ///< it does not know the greeting, or its answer makes no sense
    no_status,       ///< it takes the greeting, but its status does not come or makes no sense
    other_axes,      ///< it has another number of axes
    too_slow,        ///< it makes fewer steps per second
  };

  Kind kind = Kind::none;
  /// What the board has, from … to, and what is wanted: versions, axes, steps per second.
  std::uint32_t lowest = 0;
  std::uint32_t highest = 0;
  std::uint32_t wanted = 0;

  friend bool operator==(const LinkObstacle&, const LinkObstacle&) = default;
};

/// Of any kind but none. `board`: as the sentence begins.
[[nodiscard]] Error error_of(const LinkObstacle& obstacle,
                             std::string_view board = "The controller board");

}  // namespace cnc::hal
