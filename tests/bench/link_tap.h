// Sits in the cable between a server and a board (UDP), passes every packet on, and notes when the
// board begins to execute what a cut has brought.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cstdint>
#include <span>
#include <thread>

#include "hal/cpu5/wire/messages.h"

namespace cnc::bench {

class LinkTap {
 public:
  using Clock = std::chrono::steady_clock;

  /// Listens on a free port of the loopback for the server; the board is on `board_port`.
  explicit LinkTap(unsigned short board_port);
  ~LinkTap();

  [[nodiscard]] unsigned short port() const { return server_side_.local_endpoint().port(); }
  /// Cuts that the board has begun to execute, and when the answer that showed the last came by.
  [[nodiscard]] std::uint64_t cuts() const { return cuts_.load(std::memory_order_acquire); }
  [[nodiscard]] Clock::time_point last_cut() const {
    return Clock::time_point(Clock::duration(last_cut_.load(std::memory_order_acquire)));
  }
  [[nodiscard]] std::uint64_t packets() const { return packets_.load(std::memory_order_relaxed); }

 private:
  using Socket = boost::asio::ip::udp::socket;

  void run();
  void from_server(std::span<const std::uint8_t> packet);
  void from_board(std::span<const std::uint8_t> packet);

  boost::asio::io_context context_;
  boost::asio::ip::udp::endpoint board_;
  boost::asio::ip::udp::endpoint server_;
  Socket server_side_;
  Socket board_side_;
  hal::cpu5::firmware::HostFrame frame_;
  // The cut that is under way: the last segment that it keeps (0: none), and its frame.
  std::uint32_t behind_ = 0;
  std::uint32_t cut_frame_ = 0;
  std::atomic<std::uint64_t> cuts_{0};
  std::atomic<std::uint64_t> packets_{0};
  std::atomic<Clock::rep> last_cut_{0};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace cnc::bench
