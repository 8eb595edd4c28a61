// Lines on the UART, for whoever has a terminal there. From the main loop only; waits while the
// UART is busy.
#pragma once

#include <cstdint>

namespace cnc::hal::cpu5::target {

void start_log();
void log_line(const char* text);
void log_number(const char* text, std::uint32_t number);

}  // namespace cnc::hal::cpu5::target
