#include "hal/cpu5/driver/udp_channel.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/address.hpp>
#include <fmt/core.h>

namespace cnc::hal::cpu5 {

using boost::asio::ip::udp;
using boost::system::error_code;

namespace {

/// Datagrams of strangers that one look passes over: they must not keep the link thread busy.
constexpr int kMostStrangers = 16;

/// Only for the sentence that says so: a route that is missing now may be there in a moment.
void check_route(boost::asio::io_context& context, const udp::endpoint& board, error_code& wrong) {
  udp::socket probe(context);
  probe.open(udp::v4(), wrong);
  if (!wrong) probe.connect(board, wrong);
}

}  // namespace

UdpChannel::UdpChannel(std::string host, std::uint16_t port, Endpoint local)
    : host_(std::move(host)), port_(port), local_(local), socket_(context_) {}

std::string UdpChannel::name() const { return fmt::format("udp:{}:{}", host_, port_); }

Result<void> UdpChannel::open() {
  close();
  error_code wrong;
  const auto found =
      udp::resolver(context_).resolve(udp::v4(), host_, std::to_string(port_), wrong);
  if (!wrong) board_ = *found.begin();
  if (!wrong) check_route(context_, board_, wrong);
  if (wrong) {
    return fail(ErrorCode::board_line_unusable,
                fmt::format("The network does not lead to {}: {}.", name(), wrong.message()));
  }
  socket_.open(udp::v4(), wrong);
  if (!wrong) socket_.bind(local_, wrong);
  if (!wrong) socket_.non_blocking(true, wrong);
  if (!wrong) return {};
  close();
  return fail(ErrorCode::board_line_unusable,
              fmt::format("The address {} port {} of this computer cannot be used to reach the "
                          "board: {}. localAddress has to be its own on the machine's network.",
                          local_.address().to_string(), local_.port(), wrong.message()));
}

void UdpChannel::close() {
  error_code ignored;
  socket_.close(ignored);
}

void UdpChannel::send(std::span<const std::uint8_t> packet) {
  error_code lost;
  socket_.send_to(boost::asio::buffer(packet.data(), packet.size()), board_, 0, lost);
}

/// A datagram that is too long is cut, and then no packet.
std::span<const std::uint8_t> UdpChannel::receive() {
  for (int attempt = 0; attempt < kMostStrangers; ++attempt) {
    error_code nothing;
    Endpoint from;
    const std::size_t size = socket_.receive_from(boost::asio::buffer(memory_), from, 0, nothing);
    if (nothing) break;
    if (from == board_) return std::span(memory_).first(size);
  }
  return {};
}

}  // namespace cnc::hal::cpu5
