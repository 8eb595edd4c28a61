#include "hal/link_obstacle.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace cnc::hal {
namespace {

using Kind = LinkObstacle::Kind;

struct Row {
  Kind kind;
  ErrorCode code;
  std::string_view text;
};

/// {0} what the board has at least, {1} at most, {2} what is wanted.
constexpr std::array kRows{
    Row{Kind::silent, ErrorCode::board_silent,
        "does not answer. It has to be switched on, its cable plugged in, and the address be its "
        "own."},
    Row{Kind::busy, ErrorCode::board_busy, "is moving, or has another host that is not silent."},
    Row{Kind::other_version, ErrorCode::board_version,
        "speaks versions {0} to {1} of the protocol; this program speaks {2}."},
    Row{Kind::bad_setup, ErrorCode::board_setup_refused,
        "refused its setup: the maximum step frequency, a time of the pulses, a time-out or an "
        "acceleration is out of range."},
    Row{Kind::not_understood, ErrorCode::board_version,
        "does not understand the greeting: its firmware and this program are of different "
        "versions."},
    Row{Kind::no_status, ErrorCode::board_version,
        "takes the greeting, but gives no status that makes sense: its firmware has a fault, or is "
        "of another version than this program."},
    Row{Kind::other_axes, ErrorCode::board_unsuitable,
        "has {1} axes; this program drives boards with {2}."},
    Row{Kind::too_slow, ErrorCode::board_unsuitable,
        "makes {1} steps per second at most; {2} are set up as maxStepFrequency."},
};

}  // namespace

Error error_of(const LinkObstacle& obstacle, std::string_view board) {
  const auto row = std::ranges::find(kRows, obstacle.kind, &Row::kind);
  if (row == kRows.end()) return {ErrorCode::board_silent, fmt::format("{}.", board), {}};
  return {row->code,
          fmt::format("{} {}", board,
                      fmt::format(fmt::runtime(row->text), obstacle.lowest, obstacle.highest,
                                  obstacle.wanted)),
          {}};
}

}  // namespace cnc::hal
