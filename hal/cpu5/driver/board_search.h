// Who answers when all boards around are asked: at the usual address, on every network of this
// computer, and on the serial lines.
#pragma once

#include <boost/asio/ip/udp.hpp>
#include <string>
#include <vector>

#include "hal/cpu5/wire/messages.h"

namespace cnc::hal::cpu5 {

struct FoundBoard {
  std::string address;  ///< board_address.h
  wire::Identity identity;
};

/// Takes half a second. `local`: of this computer, to ask from.
[[nodiscard]] std::vector<FoundBoard> find_boards(const boost::asio::ip::udp::endpoint& local);

/// The serial lines on which it asks.
[[nodiscard]] std::vector<std::string> serial_lines();

}  // namespace cnc::hal::cpu5
