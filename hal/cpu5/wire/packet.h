// What every packet between host and board begins and ends with (PROTOCOL.md, "Packets").
#pragma once

#include <optional>

#include "hal/cpu5/wire/bytes.h"

namespace cnc::hal::cpu5::wire {

inline constexpr std::uint16_t kMagic = 0x3543;  ///< "C5"
inline constexpr std::uint8_t kVersion = 1;
/// Of a whole packet; an Ethernet frame takes it undivided.
inline constexpr std::size_t kMaxPacket = 1400;
inline constexpr std::size_t kHeaderSize = 8;
inline constexpr std::size_t kCrcSize = 4;

enum class PacketType : std::uint8_t {
  // from the host
  identify = 0x01,  ///< who is there? To everybody, without a session
  hello = 0x02,     ///< begins a session
  frame = 0x03,     ///< requests and segments, in order
  poll = 0x04,      ///< asks for the status
  bye = 0x05,       ///< ends the session
  // from the board
  identity = 0x81,
  welcome = 0x82,
  status = 0x83,
  refusal = 0x84,
};

struct PacketHeader {
  std::uint8_t version = kVersion;
  PacketType type = PacketType::identify;
  std::uint32_t session = 0;
};

/// Writes a packet into `memory`, which is cut off at kMaxPacket.
class PacketWriter {
 public:
  PacketWriter(std::span<std::uint8_t> memory, PacketType type, std::uint32_t session);

  /// The body goes here; room for the end is left free.
  [[nodiscard]] ByteWriter& body() { return body_; }
  /// Adds the CRC. The whole packet; empty if its body did not fit.
  [[nodiscard]] std::span<const std::uint8_t> finish();

 private:
  std::span<std::uint8_t> memory_;
  ByteWriter body_;
};

struct ReceivedPacket {
  PacketHeader header;
  ByteReader body;
};

/// Nothing unless length, magic number and CRC are right. Of another version only the header can be
/// relied on.
[[nodiscard]] std::optional<ReceivedPacket> open_packet(std::span<const std::uint8_t> packet);

}  // namespace cnc::hal::cpu5::wire
