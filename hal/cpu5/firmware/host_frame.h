// What the host sends in one exchange, and how the core carries it out.
#pragma once

#include "hal/cpu5/firmware/core.h"

namespace cnc::hal::cpu5::firmware {

/// A frame with six moving axes, changes of outputs and all requests still fits a packet of the
/// wire.
inline constexpr std::uint32_t kSegmentsPerFrame = 13;

enum class LatchRequest : std::uint8_t { none, arm_activate, arm_release, disarm };
enum class ProbeRequest : std::uint8_t { none, arm, disarm };

/// The order of the members is the order of execution, so a frame can clear a fault or release a
/// stop, switch the drives on and start to move.
struct HostFrame {
  bool quick_stop = false;
  bool clear_faults = false;
  bool release_stop = false;
  bool stop_along_path = false;
  PerAxis<LatchRequest> latch{};
  ProbeRequest probe = ProbeRequest::none;
  bool with_next = false;    ///< not before the next frame is here, too
  bool has_outputs = false;  ///< `outputs` counts; else they stay as they are
  Outputs outputs;
  OutputChange change;  ///< at once, behind `outputs`; may be empty
  bool has_cut = false;
  std::uint32_t cut_behind = 0;           ///< id of the last segment to be kept
  std::uint32_t segments_before_cut = 0;  ///< of `segments`; the others belong to the new path
  std::uint32_t segment_count = 0;
  std::array<Segment, kSegmentsPerFrame> segments;  ///< only the first segment_count are meant

  /// What a quick stop leaves of a frame that was under way: it moves and switches nothing.
  void drop_path_and_outputs();
  /// Whether it empties the board's FIFO before its segments.
  [[nodiscard]] bool empties_fifo() const { return quick_stop || clear_faults || release_stop; }
  /// Back to a frame that asks for nothing; the segments' memory is left as it is.
  void reset();
};

/// Also tells the core that the host is alive.
void execute(const HostFrame& frame, Core& core);

}  // namespace cnc::hal::cpu5::firmware
