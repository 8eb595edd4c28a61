// A CPU5 board in this process: the firmware core wired to a virtual machine, and time from the
// caller's clock, real or virtual.
#pragma once

#include "hal/cpu5/driver/board_port.h"
#include "hal/sim/virtual_machine.h"

namespace cnc::hal::sim {

class VirtualBoard final : public cpu5::BoardPort {
 public:
  VirtualBoard(const config::MachineConfig& config, const MachineOptions& options)
      : machine_(config, options), core_(machine_) {}

  [[nodiscard]] VirtualMachine& machine() { return machine_; }

  Result<cpu5::firmware::Status> open(const cpu5::firmware::Setup& setup) override;
  void close() override {}
  /// The board's time begins with the first exchange; from then on it runs as `now` does, whether
  /// or not the host is connected.
  bool exchange(double now, const cpu5::firmware::HostFrame& frame,
                cpu5::firmware::Status& status) override;

 private:
  void advance_to(double now);

  VirtualMachine machine_;
  cpu5::firmware::Core core_;
  std::optional<double> power_up_;
  cpu5::firmware::Ticks time_ = 0;
};

}  // namespace cnc::hal::sim
