// A CPU5 board in this process: the firmware wired to a virtual machine, on a clock that the caller
// moves, real or virtual. A scenario's events happen to it as its time passes.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "hal/cpu5/firmware/board_link.h"
#include "hal/sim/scenario.h"
#include "hal/sim/scenario_player.h"
#include "hal/sim/virtual_machine.h"

namespace cnc::hal::sim {

class VirtualBoard {
 public:
  VirtualBoard(const config::MachineConfig& config, const Scenario& scenario);

  [[nodiscard]] VirtualMachine& machine() { return machine_; }
  /// What is wrong with its cable now, for whoever carries the packets.
  [[nodiscard]] LinkTrouble& trouble() { return trouble_; }

  /// The board's time begins with the first call; from then on it runs as `now` does, whether or
  /// not the host is connected.
  void advance_to(double now);
  /// Where its time has come to, s.
  [[nodiscard]] double now() const { return now_; }
  /// Steps that it has made of each axis since power-up or reset.
  [[nodiscard]] cpu5::firmware::PerAxis<std::int64_t> counts() { return core_->status().counts; }
  /// A packet has come: the answer, valid until the next call; empty: none.
  std::span<const std::uint8_t> answer(std::span<const std::uint8_t> packet);
  /// As if its power had failed for a moment: it forgets everything, the machine stays as it is.
  void reset();

 private:
  void start();
  void advance_core_to(cpu5::firmware::Ticks time);
  void play_events();

  VirtualMachine machine_;
  ScenarioPlayer player_;
  LinkTrouble trouble_;
  std::optional<cpu5::firmware::Core> core_;
  std::optional<cpu5::firmware::BoardLink> link_;
  std::uint32_t boot_;  // random at power-up: a board in its place is another
  std::optional<double> power_up_;
  double now_ = 0.0;
  cpu5::firmware::Ticks time_ = 0;  // since power-up of the machine
  std::array<std::uint8_t, cpu5::wire::kMaxPacket> memory_;
};

}  // namespace cnc::hal::sim
