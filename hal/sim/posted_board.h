// A virtual board behind lines of the operating system, which keeps packets until this process
// looks for them.
//
// A process that was not scheduled for a while finds all that have come meanwhile at once. When
// each of them came is not known: a host sends evenly, so they count as having come evenly since
// the last look. Were they all to come at its end, the board would take its host for silent until
// then.
#pragma once

#include <functional>
#include <vector>

#include "hal/sim/troubled_line.h"
#include "hal/sim/virtual_board.h"

namespace cnc::hal::sim {

class PostedBoard {
 public:
  using Packet = std::vector<std::uint8_t>;
  using Send = std::function<void(std::span<const std::uint8_t>)>;

  /// `send` takes what leaves for the host.
  PostedBoard(const config::MachineConfig& config, const Scenario& scenario, Send send)
      : board_(config, scenario), send_(std::move(send)) {}

  /// `now` in seconds, from 0, never goes back; `found`: what has come since the last call, in
  /// order.
  void look(double now, std::span<const Packet> found);

 private:
  void work(double moment);

  VirtualBoard board_;
  Send send_;
  TroubledLine to_board_{1};
  TroubledLine to_host_{2};
  double looked_ = 0.0;
};

}  // namespace cnc::hal::sim
