#include "hal/cpu5/driver/board_search.h"

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fmt/core.h>
#include <ifaddrs.h>
#include <memory>
#include <net/if.h>
#include <netinet/in.h>
#include <thread>

#include "hal/cpu5/driver/serial_channel.h"
#include "hal/cpu5/driver/udp_channel.h"

namespace cnc::hal::cpu5 {
namespace {

using boost::asio::ip::udp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPatience{500};
constexpr std::chrono::milliseconds kPause{5};

std::span<const std::uint8_t> question(std::span<std::uint8_t> memory) {
  return wire::PacketWriter(memory, wire::PacketType::identify, 0).finish();
}

std::optional<wire::Identity> identity_in(std::span<const std::uint8_t> packet) {
  auto received = wire::open_packet(packet);
  wire::Identity identity;
  const bool is_identity = received && received->header.type == wire::PacketType::identity &&
                           wire::get_identity(received->body, identity);
  return is_identity ? std::optional(identity) : std::nullopt;
}

/// Everybody on the networks of this computer, each by its own broadcast address: 255.255.255.255
/// leaves through one of them only.
std::vector<boost::asio::ip::address_v4> broadcast_addresses() {
  std::vector<boost::asio::ip::address_v4> addresses;
  ::ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return addresses;
  for (const ::ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
    const bool can_shout = (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_BROADCAST) != 0;
    const ::sockaddr* const to = one->ifa_broadaddr;
    if (!can_shout || to == nullptr || to->sa_family != AF_INET) continue;
    ::sockaddr_in address{};
    std::memcpy(&address, to, sizeof address);
    addresses.emplace_back(ntohl(address.sin_addr.s_addr));
  }
  ::freeifaddrs(first);
  return addresses;
}

/// A socket that hears everybody on the networks of this computer.
class Shout {
 public:
  explicit Shout(const udp::endpoint& local) : socket_(context_) {
    error_code wrong;
    socket_.open(udp::v4(), wrong);
    socket_.bind({local.address(), 0}, wrong);
    socket_.set_option(boost::asio::socket_base::broadcast(true), wrong);
    socket_.non_blocking(true, wrong);
  }

  void ask() {
    std::array<std::uint8_t, wire::kHeaderSize + wire::kCrcSize> memory;
    const auto packet = question(memory);
    auto addresses = broadcast_addresses();
    addresses.push_back(boost::asio::ip::make_address_v4(kBoardAddress));
    addresses.push_back(boost::asio::ip::address_v4::loopback());
    for (const auto& address : addresses) {
      error_code lost;
      socket_.send_to(boost::asio::buffer(packet.data(), packet.size()),
                      udp::endpoint(address, kBoardPort), 0, lost);
    }
  }

  void hear(std::vector<FoundBoard>& boards) {
    for (;;) {
      std::array<std::uint8_t, wire::kMaxPacket> memory;
      udp::endpoint from;
      error_code nothing;
      const std::size_t size = socket_.receive_from(boost::asio::buffer(memory), from, 0, nothing);
      if (nothing) return;
      const auto identity = identity_in(std::span(memory).first(size));
      if (!identity) continue;
      boards.push_back(
          {fmt::format("udp:{}:{}", from.address().to_string(), from.port()), *identity});
    }
  }

 private:
  boost::asio::io_context context_;
  udp::socket socket_;
};

}  // namespace

std::vector<std::string> serial_lines() {
  std::vector<std::string> lines;
  for (const char* folder : {"/dev/serial/by-id", "/dev"}) {
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
      const std::string name = entry.path().filename();
      if (std::string_view(folder) != "/dev" || name.starts_with("ttyACM")) {
        lines.push_back(entry.path());
      }
    }
    if (!lines.empty()) break;  // by-id names the same lines, and keeps the names
  }
  return lines;
}

std::vector<FoundBoard> find_boards(const udp::endpoint& local) {
  std::vector<FoundBoard> boards;
  Shout shout(local);
  std::vector<std::unique_ptr<SerialChannel>> lines;
  for (const std::string& device : serial_lines()) {
    auto line = std::make_unique<SerialChannel>(device);
    if (line->open()) lines.push_back(std::move(line));
  }
  std::array<std::uint8_t, wire::kHeaderSize + wire::kCrcSize> memory;
  shout.ask();
  for (const auto& line : lines) line->send(question(memory));
  for (const auto until = Clock::now() + kPatience; Clock::now() < until;) {
    shout.hear(boards);
    for (const auto& line : lines) {
      if (const auto identity = identity_in(line->receive())) {
        boards.push_back({line->name(), *identity});
      }
    }
    std::this_thread::sleep_for(kPause);
  }
  // A board that hears more than one question answers each.
  std::ranges::sort(boards, {}, &FoundBoard::address);
  const auto [first, last] = std::ranges::unique(boards, {}, &FoundBoard::address);
  boards.erase(first, last);
  return boards;
}

}  // namespace cnc::hal::cpu5
