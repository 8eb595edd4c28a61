// The bodies of the packets (PROTOCOL.md), to bytes and back.
//
// A reader answers false for a body that is too short, too long, or holds a value that the protocol
// does not know; what it has read until then is not to be used. Ranges that depend on the machine
// (positions, speeds) are the core's part.
#pragma once

#include "hal/counting_round.h"
#include "hal/cpu5/firmware/host_frame.h"
#include "hal/cpu5/wire/packet.h"

namespace cnc::hal::cpu5::wire {

/// Who a board is and what it can do.
struct Identity {
  std::uint64_t serial = 0;
  std::uint32_t boot = 0;  ///< another after every power-up or reset: the step counts began anew
  bool in_session = false;
  std::array<char, 16> name{};           ///< ASCII, filled up with 0
  std::uint32_t max_step_frequency = 0;  ///< Hz
  std::uint16_t fifo_capacity = 0;       ///< segments
  std::uint8_t axes = 0;
  std::uint8_t window = 0;     ///< frames that it takes without having answered the first
  std::uint32_t features = 0;  ///< none defined in version 1

  friend bool operator==(const Identity&, const Identity&) = default;
};

enum class RefusalReason : std::uint8_t {
  other_version = 1,  ///< the refusal says which ones the board speaks
  busy = 2,           ///< a session with another host, which is not silent, or still moving
  bad_setup = 3,      ///< a value out of range
  no_session = 4,     ///< of this number: the board has been reset, or has another host
  not_understood = 5,
};

struct Refusal {
  RefusalReason reason = RefusalReason::not_understood;
  std::uint8_t lowest_version = kVersion;
  std::uint8_t highest_version = kVersion;
  std::uint32_t boot = 0;
};

/// In front of a frame's requests, and all that a poll has. More `stops` than the board knows of
/// are a quick stop as soon as the packet arrives, whatever frames are missing.
struct FrameNumbers {
  std::uint32_t sequence = 0;  ///< 1 for the first of a session; 0 of a poll
  std::uint32_t stops = 0;     ///< quick stops of the session that the host had asked for
  std::uint32_t stamp = 0;     ///< comes back in the answer
};

/// Where the stamp of a frame or poll stands in its packet.
inline constexpr std::size_t kStampPlace = kHeaderSize + 2 * sizeof(std::uint32_t);

/// In front of a status.
struct StatusNumbers {
  std::uint32_t answer = 0;    ///< counts up with every answer of the session
  std::uint32_t executed = 0;  ///< every frame up to this one
  std::uint32_t waiting =
      0;                    ///< bit i: frame executed + 2 + i is here and waits for an earlier one
  std::uint32_t stamp = 0;  ///< of the packet that is answered
};

void put_identity(ByteWriter& body, const Identity& identity);
[[nodiscard]] bool get_identity(ByteReader& body, Identity& identity);

void put_refusal(ByteWriter& body, const Refusal& refusal);
[[nodiscard]] bool get_refusal(ByteReader& body, Refusal& refusal);

void put_setup(ByteWriter& body, const firmware::Setup& setup);
[[nodiscard]] bool get_setup(ByteReader& body, firmware::Setup& setup);

void put_numbers(ByteWriter& body, const FrameNumbers& numbers);
[[nodiscard]] FrameNumbers get_frame_numbers(ByteReader& body);

void put_frame(ByteWriter& body, const firmware::HostFrame& frame);
[[nodiscard]] bool get_frame(ByteReader& body, firmware::HostFrame& frame);

/// Bytes of the largest: every latch tells something, every guard has counted. Times of latches
/// come back as they were if they were not longer than kLongestAgo before the status.
inline constexpr firmware::Ticks kLongestAgo = 0xFFFF'FFFF;  // 429 s
inline constexpr std::size_t kMaxStatus = 356;
void put_status(ByteWriter& body, const StatusNumbers& numbers, const firmware::Status& status);
[[nodiscard]] bool get_status(ByteReader& body, StatusNumbers& numbers, firmware::Status& status);

}  // namespace cnc::hal::cpu5::wire
