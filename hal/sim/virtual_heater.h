// A heater on a PWM output with its temperature sensor on an analog input:
//   capacity dT/dt = power * pwm - loss * (T - ambient)
#pragma once

#include <cmath>

#include "hal/sim/step_clock.h"

namespace cnc::hal::sim {

struct HeaterOptions {
  std::size_t pwm = 0;          ///< output, from 0 (PWM1)
  std::size_t analog = 0;       ///< input, from 0
  double power = 40.0;          ///< W at full PWM
  double capacity = 20.0;       ///< J/K, more than 0
  double loss = 0.2;            ///< W/K, more than 0
  double ambient = 20.0;        ///< deg C
  double sensor_range = 400.0;  ///< deg C at which the analog input reads 1; 0 deg C reads 0
};

class VirtualHeater {
 public:
  explicit VirtualHeater(const HeaterOptions& options)
      : options_(options),
        clock_(cpu5::firmware::kTicksPerSecond / 100),
        gain_(1.0 - std::exp(-clock_.step_seconds() * options.loss / options.capacity)),
        temperature_(options.ambient) {}

  [[nodiscard]] const HeaterOptions& options() const { return options_; }
  [[nodiscard]] double temperature() const { return temperature_; }  ///< deg C
  [[nodiscard]] double sensor() const { return temperature_ / options_.sensor_range; }

  /// `pwm` 0 … 1 since the last call.
  void advance(cpu5::firmware::Ticks now, double pwm) {
    const double end = options_.ambient + options_.power * pwm / options_.loss;
    while (clock_.take_step(now)) temperature_ += (end - temperature_) * gain_;
  }

 private:
  HeaterOptions options_;
  StepClock clock_;
  double gain_;  // of the way to the final temperature in one step
  double temperature_;
};

}  // namespace cnc::hal::sim
