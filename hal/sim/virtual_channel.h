// The cable to a board in this process: both directions, whatever happens to them. Both ends live
// on the caller's clock, so that a job runs in virtual time with all its lost packets.
#pragma once

#include "hal/cpu5/driver/packet_channel.h"
#include "hal/sim/troubled_line.h"
#include "hal/sim/virtual_board.h"

namespace cnc::hal::sim {

class VirtualChannel final : public cpu5::PacketChannel {
 public:
  VirtualChannel(const config::MachineConfig& config, const Scenario& scenario)
      : board_(config, scenario) {}

  [[nodiscard]] VirtualBoard& board() { return board_; }
  /// From now on.
  [[nodiscard]] LinkTrouble& trouble() { return board_.trouble(); }

  Result<void> open() override { return {}; }
  void close() override {}
  void set_time(double now) override;
  void send(std::span<const std::uint8_t> packet) override;
  std::span<const std::uint8_t> receive() override { return to_host_.take(now_); }
  [[nodiscard]] std::string name() const override { return "the virtual board"; }

 private:
  void deliver();

  VirtualBoard board_;
  TroubledLine to_board_{1};
  TroubledLine to_host_{2};
  double now_ = 0.0;
};

}  // namespace cnc::hal::sim
