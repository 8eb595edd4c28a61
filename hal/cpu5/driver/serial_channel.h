// Packets over a serial line or USB, stuffed (wire/cobs.h).
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/serial_port.hpp>
#include <sys/types.h>

#include "hal/cpu5/driver/packet_channel.h"
#include "hal/cpu5/wire/cobs.h"
#include "hal/cpu5/wire/packet.h"

namespace cnc::hal::cpu5 {

class SerialChannel final : public PacketChannel {
 public:
  /// Of a line with wires, in baud: those that Asio can set and that pass the largest status 500
  /// times a second. On a slower line the answers would queue up, and with them all that waits for
  /// them: a feed hold, a cut.
  static constexpr std::array<unsigned, 4> kRates{2'000'000, 3'000'000, 3'500'000, 4'000'000};
  static constexpr unsigned kUsualRate = kRates.front();

  /// `device`: /dev/ttyACM0. The rate, one of kRates, counts for a line with wires only, not
  /// for USB.
  explicit SerialChannel(std::string device, unsigned rate = kUsualRate);

  Result<void> open() override;
  void close() override;
  [[nodiscard]] bool is_open() const override { return port_.is_open() && !is_gone_; }
  void send(std::span<const std::uint8_t> packet) override;
  std::span<const std::uint8_t> receive() override;
  [[nodiscard]] std::string name() const override { return "serial:" + device_; }

 private:
  void write_rest();
  void note_if_gone(::ssize_t result);

  std::string device_;
  unsigned rate_;
  boost::asio::io_context context_;
  boost::asio::serial_port port_;
  bool is_gone_ = false;  // pulled out; closing it would be too slow for the link thread
  wire::CobsReader<wire::kMaxPacket> reader_;
  std::array<std::uint8_t, 4096> read_{};
  std::size_t read_place_ = 0;
  std::size_t read_size_ = 0;
  std::array<std::uint8_t, wire::cobs_size(wire::kMaxPacket)> written_{};
  std::size_t write_place_ = 0;  // what the line has not taken yet
  std::size_t write_size_ = 0;
};

}  // namespace cnc::hal::cpu5
