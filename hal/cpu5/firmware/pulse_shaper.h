// From steps to the edges on a drive's pins, for six axes: a step pulse keeps its width, the pause
// after it is as long at least, and the direction stands direction_setup before the pulse and
// direction_hold after its beginning. All of them are counted from the edges that were really made,
// so an interrupt that comes late makes pulses late but never short, and loses none.
//
// Every pulse begins direction_setup after its step is due: so a change of direction finds its time
// without holding up one axis alone. Where an axis turns round within less than hold and set-up,
// its next pulses are late until the pauses have made up for it.
//
// Belongs to the step interrupt.
#pragma once

#include "hal/cpu5/firmware/segment.h"

namespace cnc::hal::cpu5::firmware {

/// Whether pulses of this shape can be made at the setup's highest step frequency.
[[nodiscard]] bool pulses_possible(const Setup& setup);

class PulseShaper {
 public:
  /// What the outputs have to be, polarity included; one bit per axis.
  struct Pins {
    std::uint8_t step = 0;
    std::uint8_t direction = 0;  ///< high: upwards, unless inverted

    friend bool operator==(const Pins&, const Pins&) = default;
  };

  /// With pulses_possible(), and while nothing moves; the last pulse may still be high. Not from
  /// the step interrupt, which must not come in between.
  void set_up(const Setup& setup);

  /// False when more steps of the axis are waiting than the drives' times allow: that one is lost.
  /// Only a path that turns round again and again at full speed comes to that.
  [[nodiscard]] bool add_step(std::size_t axis, int direction, Ticks when);

  /// Makes the edges that are due; at most one edge of each pin.
  Pins make_edges(Ticks now);
  /// When the next one will be; kNever without steps.
  [[nodiscard]] Ticks next_edge() const { return next_edge_; }
  static constexpr Ticks kNever = Ticks{1} << 62;

 private:
  struct Step {
    Ticks due;
    bool upwards;
  };
  class Axis {
   public:
    [[nodiscard]] bool add(const Step& step, const Setup& setup);
    /// The one that is due at `edge`. True for one of the direction.
    bool make_edge(Ticks now, const Setup& setup);

    Ticks edge = kNever;
    bool high = false;
    bool upwards = false;

   private:
    static constexpr std::uint32_t kWaiting = 64;

    void find_edge(const Setup& setup);
    [[nodiscard]] const Step& next() const { return steps_[taken_ % kWaiting]; }
    [[nodiscard]] bool has_to_turn() const { return next().upwards != upwards; }

    std::array<Step, kWaiting> steps_;
    std::uint32_t added_ = 0;
    std::uint32_t taken_ = 0;
    Ticks rise_ = -kTicksPerSecond;  // of the last pulse
    Ticks fall_ = -kTicksPerSecond;
    Ticks turn_ = -kTicksPerSecond;  // of the direction
  };

  Ticks next_edge_ = kNever;
  Pins pins_;
  Setup setup_;
  PerAxis<Axis> axes_;
};

}  // namespace cnc::hal::cpu5::firmware
