// Where a board is: "udp:172.22.2.100:5005", "serial:/dev/ttyACM0", "serial:/dev/ttyUSB0@3000000"
// with the baud rate of a line with wires, or "auto", which asks around until one answers.
#pragma once

#include <memory>
#include <string_view>

#include "hal/cpu5/driver/lasting_channel.h"

namespace cnc::hal::cpu5 {

/// The way to the board of that address, and from that one of this computer: "auto",
/// "172.22.2.101", or with a port "172.22.2.101:5006". An error says that one of them is none;
/// whether a board is there shows later, and again and again. `listener` may be called by a thread
/// of the channel's.
Result<std::unique_ptr<PacketChannel>> make_channel(
    std::string_view address, std::string_view local_address = "auto",
    LastingChannel::Listener listener = [](const Result<std::string>&) {});

}  // namespace cnc::hal::cpu5
