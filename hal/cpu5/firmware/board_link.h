// The board's side of the wire (hal/cpu5/PROTOCOL.md): sessions, frames in their order, and an
// answer to every packet that deserves one.
//
// A packet that is damaged, or not meant for this board, is passed over in silence: whoever sent it
// will ask again. Frames that come early wait until those before them are here; frames that come
// again are answered, not executed again. Not thread-safe; no heap.
#pragma once

#include "hal/cpu5/firmware/host_frame.h"
#include "hal/cpu5/wire/messages.h"

namespace cnc::hal::cpu5::firmware {

/// Frames that may be on their way at the same time: 416 segments, 0.1 s of the shortest.
inline constexpr std::uint32_t kFrameWindow = 32;

/// What tells one board from another.
struct BoardName {
  std::uint64_t serial = 0;
  std::uint32_t boot = 0;  ///< random, or counted up, at every power-up and reset
  std::array<char, 16> name{};
};

class BoardLink {
 public:
  BoardLink(Core& core, const BoardName& name) : core_(core), name_(name) {}

  /// The answer is written into `memory` (wire::kMaxPacket bytes); empty: none. The core's time is
  /// what it was last given.
  std::span<const std::uint8_t> answer(std::span<const std::uint8_t> packet,
                                       std::span<std::uint8_t> memory);

  [[nodiscard]] bool in_session() const { return session_ != 0; }

 private:
  struct WaitingFrame {
    bool here = false;
    std::uint32_t stops = 0;  // asked for before it was sent
    HostFrame frame;
  };

  [[nodiscard]] bool takes_session(std::uint32_t session, wire::ByteReader& body,
                                   wire::RefusalReason& why);
  void begin_session(std::uint32_t session);
  void take_stop(std::uint32_t stops);
  [[nodiscard]] bool take_frame(const wire::FrameNumbers& numbers, wire::ByteReader& body);
  void execute_in_order();
  [[nodiscard]] WaitingFrame& next_frame() { return waiting_[(executed_ + 1) % kFrameWindow]; }
  [[nodiscard]] bool group_is_here() const;
  [[nodiscard]] wire::Identity identity() const;
  [[nodiscard]] wire::StatusNumbers numbers_of_answer(std::uint32_t stamp);

  Core& core_;
  BoardName name_;
  std::uint32_t session_ = 0;   // 0: none
  Ticks heard_ = 0;             // the host of the session
  std::uint32_t executed_ = 0;  // every frame up to this one
  std::uint32_t answers_ = 0;
  std::uint32_t stops_ = 0;
  std::array<WaitingFrame, kFrameWindow> waiting_;  // by number
};

}  // namespace cnc::hal::cpu5::firmware
