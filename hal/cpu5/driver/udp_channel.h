// Packets as UDP datagrams, one each.
//
// The socket is not connected to the board: that would choose this computer's own address once, by
// the routes of that moment, and a network that comes up later would never be used. So each
// datagram takes the route of its time, and what others send is passed over.
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
  using Endpoint = boost::asio::ip::udp::endpoint;

  /// `host`: address or name; looked up by open(). `local`: of this computer; by itself, whatever
  /// leads to the board and any free port.
  explicit UdpChannel(std::string host, std::uint16_t port = kBoardPort, Endpoint local = {});

  Result<void> open() override;
  void close() override;
  [[nodiscard]] bool is_open() const override { return socket_.is_open(); }
  void send(std::span<const std::uint8_t> packet) override;
  std::span<const std::uint8_t> receive() override;
  [[nodiscard]] std::string name() const override;

 private:
  std::string host_;
  std::uint16_t port_;
  Endpoint local_;
  boost::asio::io_context context_;
  Endpoint board_;
  boost::asio::ip::udp::socket socket_;
  std::array<std::uint8_t, wire::kMaxPacket + 1> memory_{};
};

}  // namespace cnc::hal::cpu5
