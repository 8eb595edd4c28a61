// Where a board is: "udp:172.22.2.100:5005", "serial:/dev/ttyACM0", "serial:/dev/ttyUSB0@3000000"
// with the baud rate of a line with wires, or "auto", which asks around.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/cpu5/driver/packet_channel.h"
#include "hal/cpu5/wire/messages.h"

namespace cnc::hal::cpu5 {

/// The way to the board of that address. Asks around for "auto", which takes half a second; an
/// error says what was tried.
Result<std::unique_ptr<PacketChannel>> make_channel(std::string_view address);

struct FoundBoard {
  std::string address;
  wire::Identity identity;
};

/// Whoever answers, at the usual address and on the network around, and on the serial lines.
[[nodiscard]] std::vector<FoundBoard> find_boards();

}  // namespace cnc::hal::cpu5
