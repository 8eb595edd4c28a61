#include "hal/sim/posted_board.h"

#include <algorithm>

namespace cnc::hal::sim {

void PostedBoard::look(double now, std::span<const Packet> found) {
  const double step = (now - looked_) / static_cast<double>(std::max<std::size_t>(found.size(), 1));
  double came = looked_;
  for (const Packet& packet : found) {
    came = std::min(came + step, now);
    to_board_.put(packet, came, board_.trouble());
    work(came);
  }
  work(now);
  looked_ = now;
}

void PostedBoard::work(double moment) {
  board_.advance_to(moment);
  for (auto packet = to_board_.take(moment); !packet.empty(); packet = to_board_.take(moment))
    to_host_.put(board_.answer(packet), moment, board_.trouble());
  for (auto packet = to_host_.take(moment); !packet.empty(); packet = to_host_.take(moment))
    send_(packet);
}

}  // namespace cnc::hal::sim
