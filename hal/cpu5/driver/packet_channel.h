// The way that packets take to a board and back: a socket, a serial line, or memory.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "config/error.h"

namespace cnc::hal::cpu5 {

class PacketChannel {
 public:
  virtual ~PacketChannel() = default;

  /// May take its time and allocate; what follows behind close() does neither.
  virtual Result<void> open() = 0;
  virtual void close() = 0;
  /// Whether packets can leave. A device that is gone is not open until open() finds it again.
  [[nodiscard]] virtual bool is_open() const { return true; }
  /// The caller's clock, seconds, before packets are sent or received: for channels in memory,
  /// whose other end has no clock of its own.
  virtual void set_time(double /*now*/) {}
  /// Never waits: a packet that the line does not take now is lost.
  virtual void send(std::span<const std::uint8_t> packet) = 0;
  /// The next packet that has come, valid until the next call; empty: none. Never waits.
  virtual std::span<const std::uint8_t> receive() = 0;
  /// Nobody has answered for a while: the board may be elsewhere by now.
  virtual void look_elsewhere() {}
  /// For messages: "UDP 172.22.2.100 port 5005".
  [[nodiscard]] virtual std::string name() const = 0;
};

}  // namespace cnc::hal::cpu5
