#include "hal/sim/virtual_channel.h"

namespace cnc::hal::sim {

void VirtualChannel::set_time(double now) {
  now_ = now;
  deliver();
  board_.advance_to(now);
}

void VirtualChannel::send(std::span<const std::uint8_t> packet) {
  to_board_.put(packet, now_, trouble());
  deliver();
}

/// Each packet at the board's time of its arrival.
void VirtualChannel::deliver() {
  for (auto arrival = to_board_.next_arrival(); arrival && *arrival <= now_;
       arrival = to_board_.next_arrival()) {
    if (*arrival > board_.now()) board_.advance_to(*arrival);
    to_host_.put(board_.answer(to_board_.take(now_)), *arrival, trouble());
  }
}

}  // namespace cnc::hal::sim
