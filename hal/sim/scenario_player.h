// Makes a scenario's events happen: those with a time at that time, those with a place within a
// millisecond of the axis passing it. Each happens once; simultaneous ones in the file's order.
//
// Real-time: advance() allocates nothing and takes no lock.
#pragma once

#include <limits>
#include <vector>

#include "hal/sim/link_trouble.h"
#include "hal/sim/scenario_event.h"

namespace cnc::hal::sim {

class VirtualMachine;

/// What events act on.
struct Stage {
  VirtualMachine& machine;
  LinkTrouble& trouble;
  bool reset_board =
      false;  ///< set by an event; whoever owns the board restarts it and clears this
};

class ScenarioPlayer {
 public:
  using Ticks = cpu5::firmware::Ticks;

  static constexpr Ticks kNever = std::numeric_limits<Ticks>::max();
  /// From one look at the axes' places to the next.
  static constexpr Ticks kLookInterval = cpu5::firmware::kTicksPerSecond / 1000;

  explicit ScenarioPlayer(std::vector<ScenarioEvent> events);

  /// When advance() has something to do next; kNever when nothing is left.
  [[nodiscard]] Ticks next() const { return next_; }
  /// Everything that is due at `now`, the time since power-up, which never goes back.
  void advance(Ticks now, Stage& stage);

 private:
  struct Timed {
    Ticks time;
    ScenarioAction action;
  };
  struct Placed {
    PlacePassed place;
    ScenarioAction action;
    bool came_from_before;
    bool done;
  };

  void look(Placed& event, Stage& stage);

  std::vector<Timed> timed_;  // in the order of time
  std::size_t timed_done_ = 0;
  std::vector<Placed> placed_;
  std::size_t placed_left_;
  Ticks next_ = 0;
};

}  // namespace cnc::hal::sim
