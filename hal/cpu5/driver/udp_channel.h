// Packets as UDP datagrams, one each.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "hal/cpu5/driver/packet_channel.h"
#include "hal/cpu5/wire/packet.h"

namespace cnc::hal::cpu5 {

/// Where a board listens unless it was told otherwise.
inline constexpr std::uint16_t kBoardPort = 5005;
inline constexpr const char* kBoardAddress = "172.22.2.100";

class UdpChannel final : public PacketChannel {
 public:
  /// `host`: address or name; looked up by open().
  explicit UdpChannel(std::string host, std::uint16_t port = kBoardPort);

  Result<void> open() override;
  void close() override;
  void send(std::span<const std::uint8_t> packet) override;
  std::span<const std::uint8_t> receive() override;
  [[nodiscard]] std::string name() const override;

 private:
  std::string host_;
  std::uint16_t port_;
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  std::array<std::uint8_t, wire::kMaxPacket + 1> memory_{};
};

}  // namespace cnc::hal::cpu5
