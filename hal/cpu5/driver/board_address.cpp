#include "hal/cpu5/driver/board_address.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fmt/core.h>
#include <fmt/ranges.h>
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

/// A socket that hears everybody on the networks of this computer.
class Shout {
 public:
  Shout() : socket_(context_) {
    error_code wrong;
    socket_.open(udp::v4(), wrong);
    socket_.set_option(boost::asio::socket_base::broadcast(true), wrong);
    socket_.non_blocking(true, wrong);
  }

  void ask() {
    std::array<std::uint8_t, wire::kHeaderSize + wire::kCrcSize> memory;
    const auto packet = question(memory);
    for (const auto& address :
         {boost::asio::ip::make_address_v4(kBoardAddress), boost::asio::ip::address_v4::broadcast(),
          boost::asio::ip::address_v4::loopback()}) {
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

/// The port behind the last colon, if there is one.
Result<std::unique_ptr<PacketChannel>> make_udp_channel(std::string_view rest) {
  const auto colon = rest.rfind(':');
  std::uint16_t port = kBoardPort;
  if (colon != rest.npos) {
    const auto text = rest.substr(colon + 1);
    const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (wrong != std::errc{} || end != text.data() + text.size() || port == 0) {
      return fail(ErrorCode::board_address_wrong,
                  fmt::format("\"{}\" is no port; it has to be a number from 1 to 65535.", text));
    }
  }
  return std::make_unique<UdpChannel>(std::string(rest.substr(0, colon)), port);
}

/// Names of devices have colons; the rate is behind the last @.
Result<std::unique_ptr<PacketChannel>> make_serial_channel(std::string_view rest) {
  const auto at = rest.rfind('@');
  unsigned rate = SerialChannel::kUsualRate;
  if (at != rest.npos) {
    const auto text = rest.substr(at + 1);
    const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), rate);
    if (wrong != std::errc{} || end != text.data() + text.size() ||
        std::ranges::find(SerialChannel::kRates, rate) == SerialChannel::kRates.end()) {
      return fail(
          ErrorCode::board_address_wrong,
          fmt::format(
              "\"{}\" is no baud rate for a board: a serial line with wires runs at "
              "one of {}; on a slower one the board's answers come late. USB needs no rate.",
              text, fmt::join(SerialChannel::kRates, ", ")));
    }
  }
  return std::make_unique<SerialChannel>(std::string(rest.substr(0, at)), rate);
}

}  // namespace

std::vector<FoundBoard> find_boards() {
  std::vector<FoundBoard> boards;
  Shout shout;
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

Result<std::unique_ptr<PacketChannel>> make_channel(std::string_view address) {
  constexpr std::string_view kUdp = "udp:";
  constexpr std::string_view kSerial = "serial:";
  if (address.starts_with(kUdp)) return make_udp_channel(address.substr(kUdp.size()));
  if (address.starts_with(kSerial)) return make_serial_channel(address.substr(kSerial.size()));
  if (address != "auto") {
    return fail(
        ErrorCode::board_address_wrong,
        fmt::format("\"{}\" is no address of a board: it has to be auto, udp:HOST:PORT or "
                    "serial:/dev/NAME, with @RATE behind it for a line with wires that does "
                    "not run at {} baud.",
                    address, SerialChannel::kUsualRate));
  }
  const auto boards = find_boards();
  if (boards.size() == 1) return make_channel(boards.front().address);
  if (boards.empty()) {
    return fail(ErrorCode::board_silent,
                fmt::format("No controller board was found: none answers at {}, on the networks of "
                            "this computer, or on the serial lines {} at {} baud.",
                            kBoardAddress, serial_lines(), SerialChannel::kUsualRate));
  }
  std::vector<std::string> addresses;
  for (const FoundBoard& board : boards) addresses.push_back(board.address);
  return fail(ErrorCode::board_address_wrong,
              fmt::format("There are {} controller boards, {}: say which.", boards.size(),
                          fmt::join(addresses, ", ")));
}

}  // namespace cnc::hal::cpu5
