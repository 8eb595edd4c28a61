#include "tests/bench/link_tap.h"

#include <array>
#include <poll.h>
#include <pthread.h>

namespace cnc::bench {
namespace {

namespace wire = hal::cpu5::wire;
using boost::asio::ip::udp;

udp::endpoint loopback(unsigned short port) {
  return {boost::asio::ip::address_v4::loopback(), port};
}

constexpr int kPriority = 60;  // above the server's link thread: a cable has no load

}  // namespace

LinkTap::LinkTap(unsigned short board_port)
    : board_(loopback(board_port)),
      server_side_(context_, loopback(0)),
      board_side_(context_, loopback(0)) {
  server_side_.non_blocking(true);
  board_side_.non_blocking(true);
  thread_ = std::thread([this] { run(); });
}

LinkTap::~LinkTap() {
  ending_ = true;
  thread_.join();
}

void LinkTap::run() {
  const sched_param priority{.sched_priority = kPriority};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority));
  std::array<std::uint8_t, wire::kMaxPacket> memory{};
  std::array<pollfd, 2> handles{pollfd{server_side_.native_handle(), POLLIN, 0},
                                pollfd{board_side_.native_handle(), POLLIN, 0}};
  while (!ending_) {
    if (::poll(handles.data(), handles.size(), 100) <= 0) continue;
    boost::system::error_code nothing;
    for (;;) {
      const auto size = server_side_.receive_from(boost::asio::buffer(memory), server_, 0, nothing);
      if (nothing) break;
      from_server(std::span(memory).first(size));
      board_side_.send_to(boost::asio::buffer(memory, size), board_, 0, nothing);
      ++packets_;
    }
    udp::endpoint from;
    for (;;) {
      const auto size = board_side_.receive_from(boost::asio::buffer(memory), from, 0, nothing);
      if (nothing) break;
      server_side_.send_to(boost::asio::buffer(memory, size), server_, 0, nothing);
      from_board(std::span(memory).first(size));
      ++packets_;
    }
  }
}

void LinkTap::from_server(std::span<const std::uint8_t> packet) {
  auto received = wire::open_packet(packet);
  if (!received || received->header.type != wire::PacketType::frame) return;
  const wire::FrameNumbers numbers = wire::get_frame_numbers(received->body);
  if (!wire::get_frame(received->body, frame_) || !frame_.has_cut) return;
  behind_ = frame_.cut_behind;
  cut_frame_ = numbers.sequence;
}

void LinkTap::from_board(std::span<const std::uint8_t> packet) {
  if (behind_ == 0) return;
  auto received = wire::open_packet(packet);
  if (!received || received->header.type != wire::PacketType::status) return;
  wire::StatusNumbers numbers;
  hal::cpu5::firmware::Status status;
  if (!wire::get_status(received->body, numbers, status)) return;
  if (hal::is_newer(cut_frame_, numbers.executed)) return;
  if (!status.cut_late && !hal::is_newer(status.executing_id, behind_)) return;
  behind_ = 0;
  if (status.cut_late) return;  // the server cuts again
  last_cut_.store(Clock::now().time_since_epoch().count(), std::memory_order_release);
  cuts_.fetch_add(1, std::memory_order_release);
}

}  // namespace cnc::bench
