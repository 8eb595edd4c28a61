// Packets on a serial line: Consistent Overhead Byte Stuffing (Cheshire & Baker, IEEE/ACM ToN 7,
// 1999). A packet is written without a single 0 byte, one byte longer for every 254, and a 0 ends
// it: whoever has missed something is in step again with the next 0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace cnc::hal::cpu5::wire {

/// Bytes that a packet takes on the line at most, with the 0 at its end.
[[nodiscard]] constexpr std::size_t cobs_size(std::size_t packet) {
  return packet + packet / 254 + 2;
}

/// Writes the packet for the line; `line` has cobs_size() bytes. Returns how many were written.
std::size_t write_cobs(std::span<const std::uint8_t> packet, std::span<std::uint8_t> line);

/// Finds the packets among the bytes that come from a line. What is longer than kCapacity, or cut
/// off in the middle, is dropped; that what is left is whole is for its CRC to say.
template <std::size_t kCapacity>
class CobsReader {
 public:
  /// True when a packet is complete; it stays until the next call.
  bool take(std::uint8_t byte) {
    if (complete_) restart();
    if (byte == 0) {
      complete_ = size_ > 0 && left_ == 0 && !dropped_;
      if (!complete_) restart();
      return complete_;
    }
    if (left_ == 0) {
      if (gap_due_) append(0);
      left_ = byte - std::size_t{1};
      gap_due_ = byte != 0xFF;
      return false;
    }
    append(byte);
    --left_;
    return false;
  }

  [[nodiscard]] std::span<const std::uint8_t> packet() const {
    return std::span(packet_).first(size_);
  }

 private:
  void append(std::uint8_t byte) {
    if (size_ < kCapacity) {
      packet_[size_++] = byte;
    } else {
      dropped_ = true;
    }
  }
  void restart() {
    size_ = left_ = 0;
    gap_due_ = dropped_ = complete_ = false;
  }

  std::array<std::uint8_t, kCapacity> packet_{};
  std::size_t size_ = 0;
  std::size_t left_ = 0;  // bytes of the present block
  bool gap_due_ = false;  // a 0 stands between this block and the next
  bool dropped_ = false;
  bool complete_ = false;
};

}  // namespace cnc::hal::cpu5::wire
