// The pins of the image: step and direction of six axes, inputs and outputs.
#pragma once

#include "hal/cpu5/firmware/board_io.h"
#include "hal/cpu5/firmware/pulse_shaper.h"

namespace cnc::hal::cpu5::target {

class Pins final : public firmware::BoardIo {
 public:
  /// The pins become outputs, at rest.
  void start();

  void set_up(const firmware::Setup& setup) override;
  void step(std::size_t axis, int direction, firmware::Ticks when) override;
  firmware::Inputs inputs(firmware::Ticks now) override;
  void set_outputs(const firmware::Outputs& outputs) override;

  void make_edges(firmware::Ticks now);
  [[nodiscard]] firmware::Ticks next_edge() const { return shaper_.next_edge(); }
  /// Of a pulse, since the last call: the path turns round faster than the drives can.
  bool take_loss();

 private:
  firmware::PulseShaper shaper_;
  bool lost_ = false;
};

}  // namespace cnc::hal::cpu5::target
