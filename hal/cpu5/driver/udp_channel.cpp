#include "hal/cpu5/driver/udp_channel.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/address.hpp>
#include <fmt/core.h>

namespace cnc::hal::cpu5 {

using boost::asio::ip::udp;
using boost::system::error_code;

UdpChannel::UdpChannel(std::string host, std::uint16_t port)
    : host_(std::move(host)), port_(port), socket_(context_) {}

std::string UdpChannel::name() const { return fmt::format("udp:{}:{}", host_, port_); }

Result<void> UdpChannel::open() {
  close();
  error_code wrong;
  const auto found =
      udp::resolver(context_).resolve(udp::v4(), host_, std::to_string(port_), wrong);
  // Connected: only what comes from there is received.
  if (!wrong) socket_.open(udp::v4(), wrong);
  if (!wrong) socket_.connect(*found.begin(), wrong);
  if (!wrong) socket_.non_blocking(true, wrong);
  if (!wrong) return {};
  return fail(ErrorCode::board_line_unusable,
              fmt::format("The network does not lead to {}: {}.", name(), wrong.message()));
}

void UdpChannel::close() {
  error_code ignored;
  socket_.close(ignored);
}

void UdpChannel::send(std::span<const std::uint8_t> packet) {
  error_code lost;
  socket_.send(boost::asio::buffer(packet.data(), packet.size()), 0, lost);
}

/// A datagram that is too long is cut, and then no packet. That nobody listens there is told by an
/// error in between; the next datagram may be waiting behind it.
std::span<const std::uint8_t> UdpChannel::receive() {
  for (int attempt = 0; attempt < 2; ++attempt) {
    error_code nothing;
    const std::size_t size = socket_.receive(boost::asio::buffer(memory_), 0, nothing);
    if (!nothing) return std::span(memory_).first(size);
    if (nothing != boost::asio::error::connection_refused) break;
  }
  return {};
}

}  // namespace cnc::hal::cpu5
