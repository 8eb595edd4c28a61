#include "hal/cpu5/driver/board_address.h"

#include <algorithm>
#include <boost/asio/ip/address_v4.hpp>
#include <charconv>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "hal/cpu5/driver/board_search.h"
#include "hal/cpu5/driver/serial_channel.h"
#include "hal/cpu5/driver/udp_channel.h"

namespace cnc::hal::cpu5 {
namespace {

using boost::asio::ip::udp;
using boost::system::error_code;
using Made = Result<std::unique_ptr<PacketChannel>>;

/// Asking around opens every serial line: not too often.
constexpr std::chrono::milliseconds kSearchPause{2000};

struct Way {
  bool may_lead_elsewhere = false;
  LastingChannel::Maker make;
  std::chrono::milliseconds pause{500};
};

Made opened(std::unique_ptr<PacketChannel> channel) {
  if (auto done = channel->open(); !done) return std::unexpected(done.error());
  return channel;
}

Result<std::uint16_t> read_port(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (wrong == std::errc{} && end == text.data() + text.size() && port != 0) return port;
  return fail(ErrorCode::board_address_wrong,
              fmt::format("\"{}\" is no port; it has to be a number from 1 to 65535.", text));
}

/// "auto", "172.22.2.101" or "172.22.2.101:5006".
Result<udp::endpoint> read_local(std::string_view text) {
  if (text == "auto") return udp::endpoint{};
  const auto colon = text.rfind(':');
  error_code wrong;
  const auto address = boost::asio::ip::make_address_v4(std::string(text.substr(0, colon)), wrong);
  if (wrong) {
    return fail(ErrorCode::board_address_wrong,
                fmt::format("\"{}\" is no address of this computer: it has to be auto, or like "
                            "172.22.2.101 or, with a port, 172.22.2.101:5006.",
                            text));
  }
  if (colon == text.npos) return udp::endpoint{address, 0};
  const auto port = read_port(text.substr(colon + 1));
  if (!port) return std::unexpected(port.error());
  return udp::endpoint{address, *port};
}

/// The port behind the last colon, if there is one.
Result<Way> udp_way(std::string_view rest, const udp::endpoint& local) {
  const auto colon = rest.rfind(':');
  std::uint16_t port = kBoardPort;
  if (colon != rest.npos) {
    const auto read = read_port(rest.substr(colon + 1));
    if (!read) return std::unexpected(read.error());
    port = *read;
  }
  // A name may lead to another address by then.
  return Way{.may_lead_elsewhere = true,
             .make = [host = std::string(rest.substr(0, colon)), port, local] {
               return opened(std::make_unique<UdpChannel>(host, port, local));
             }};
}

/// Names of devices have colons; the rate is behind the last @.
Result<Way> serial_way(std::string_view rest) {
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
  return Way{.may_lead_elsewhere = false, .make = [device = std::string(rest.substr(0, at)), rate] {
               return opened(std::make_unique<SerialChannel>(device, rate));
             }};
}

/// Whoever answers, if that is one.
Made make_found(const udp::endpoint& local);

Result<Way> way_to(std::string_view address, const udp::endpoint& local) {
  constexpr std::string_view kUdp = "udp:";
  constexpr std::string_view kSerial = "serial:";
  if (address.starts_with(kUdp)) return udp_way(address.substr(kUdp.size()), local);
  if (address.starts_with(kSerial)) return serial_way(address.substr(kSerial.size()));
  if (address == "auto") {
    return Way{.may_lead_elsewhere = true,
               .make = [local] { return make_found(local); },
               .pause = kSearchPause};
  }
  return fail(ErrorCode::board_address_wrong,
              fmt::format("\"{}\" is no address of a board: it has to be auto, udp:HOST:PORT or "
                          "serial:/dev/NAME, with @RATE behind it for a line with wires that does "
                          "not run at {} baud.",
                          address, SerialChannel::kUsualRate));
}

Made make_found(const udp::endpoint& local) {
  const auto boards = find_boards(local);
  if (boards.empty()) {
    return fail(ErrorCode::board_silent,
                fmt::format("No controller board was found: none answers at {}, on the networks of "
                            "this computer, or on the serial lines {} at {} baud.",
                            kBoardAddress, serial_lines(), SerialChannel::kUsualRate));
  }
  if (boards.size() > 1) {
    std::vector<std::string> addresses;
    for (const FoundBoard& board : boards) addresses.push_back(board.address);
    return fail(ErrorCode::board_ambiguous,
                fmt::format("There are {} controller boards, {}: the setting board has to say "
                            "which, or one of them has to be switched off.",
                            boards.size(), fmt::join(addresses, ", ")));
  }
  const auto way = way_to(boards.front().address, local);
  if (!way) return std::unexpected(way.error());
  return way->make();
}

}  // namespace

Result<std::unique_ptr<PacketChannel>> make_channel(std::string_view address,
                                                    std::string_view local_address,
                                                    LastingChannel::Listener listener) {
  const auto local = read_local(local_address);
  if (!local) return std::unexpected(local.error());
  auto way = way_to(address, *local);
  if (!way) return std::unexpected(way.error());
  return std::make_unique<LastingChannel>(
      std::move(way->make), LastingChannel::Settings{.name = std::string(address),
                                                     .pause = way->pause,
                                                     .may_lead_elsewhere = way->may_lead_elsewhere,
                                                     .listener = std::move(listener)});
}

}  // namespace cnc::hal::cpu5
