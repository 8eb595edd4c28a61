// A machine to try things on: the real one, with a virtual board behind it, in virtual time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/simulation/simulation.h"

namespace cnc::server::test {

/// The shipped configuration with `settings` ("SECTION.key=value") in the place of its own. Its
/// drives have encoders (drivesHoldPosition), so that a test sees what else costs trust. No work
/// offset: work coordinates are machine coordinates.
[[nodiscard]] MachineData shipped_machine(const std::vector<std::string>& settings = {});

/// The same without mandatory homing: ready after a reset, and standing at machine zero.
[[nodiscard]] MachineData free_machine(std::vector<std::string> settings = {});

/// Standing at machine zero.
[[nodiscard]] SimulationOptions at_zero();

class Rig {
 public:
  /// Switched on and connected: the state is "needs reset".
  explicit Rig(MachineData data = free_machine(), const SimulationOptions& options = at_zero());

  Simulation simulation;
  Machine& machine;

  void run_for(double seconds);
  /// Cycles until the state is reached; false when that takes longer than `seconds`.
  [[nodiscard]] bool becomes(State state, double seconds = 60.0);
  [[nodiscard]] bool becomes(const std::function<bool()>& condition, double seconds = 60.0);

  /// becomes() for what also waits for the disk, which knows no virtual time.
  [[nodiscard]] bool becomes_with_disk(const std::function<bool()>& condition,
                                       double seconds = 60.0);

  /// Gives a command that answers through a completion and cycles until it does.
  Result<void> complete(const std::function<void(Completion)>& command, double seconds = 120.0);
  Result<void> reset();
  Result<void> home(std::vector<Axis> axes = {});
  Result<void> mdi(const std::string& line);
  Result<void> pause();
  Result<void> stop();
  /// Loads a program from its text.
  Result<void> load(const std::string& text);
  /// Loads and starts it.
  void start(const std::string& text);

  [[nodiscard]] std::shared_ptr<const MachineSnapshot> shown() const {
    return machine.snapshots().newest();
  }
  [[nodiscard]] Position position() const { return shown()->machine_position; }
  [[nodiscard]] State state() const { return machine.state(); }
  [[nodiscard]] bool homed(Axis axis) const { return shown()->trust[axis] == Trust::trusted; }
  /// The newest message that is an error.
  [[nodiscard]] Error last_error() const;
};

/// Drives on; ready.
struct ReadyRig : Rig {
  explicit ReadyRig(MachineData data = free_machine(),
                    const SimulationOptions& options = at_zero());
};

/// Every axis homed by hand where it stands; Z therefore stands at its home position 10.
struct HomedRig : ReadyRig {
  explicit HomedRig(std::vector<std::string> settings = {});
};

}  // namespace cnc::server::test
