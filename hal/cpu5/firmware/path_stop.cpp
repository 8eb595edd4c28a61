#include "hal/cpu5/firmware/path_stop.h"

namespace cnc::hal::cpu5::firmware {
namespace {

constexpr std::int64_t clamped(std::int64_t value, std::int64_t limit) {
  if (value > limit) return limit;
  return value < -limit ? -limit : value;
}

// Sixteen bits of s^2 keep the product with kTopAcceleration within 2^59.
constexpr StepAcceleration times_square(StepAcceleration acceleration, TimeScale scale) {
  constexpr int kSquareBits = 16;
  const std::int64_t root = scale >> kScaleBits / 2;
  const std::int64_t square = root * root >> (kScaleBits - kSquareBits);
  return acceleration * square >> kSquareBits;
}

}  // namespace

// left < 2^44, so that the longest slice and the six bits from 2^-24 (2^-56 / 2^-32) to the scale's
// 2^-30 fit 64 bits.
TimeScale allowed_loss(const PathDerivatives& axis, StepAcceleration max_acceleration,
                       TimeScale scale, Ticks length) {
  if (max_acceleration == 0 || axis.velocity == 0) return kFullScale;
  const std::int64_t sense = axis.velocity < 0 ? -1 : 1;
  const StepAcceleration planned =
      times_square(clamped(sense * axis.acceleration, kTopAcceleration), scale);
  const StepAcceleration left = max_acceleration + planned;
  if (left <= 0) return 0;
  constexpr int kMissingBits = kScaleBits - (kAccelerationBits - kFractionBits);
  const TimeScale loss = (left * length << kMissingBits) / (sense * axis.velocity);
  return loss < kFullScale ? loss : kFullScale;
}

TimeScale allowed_gain(const PathDerivatives& axis, StepAcceleration max_acceleration,
                       TimeScale scale, Ticks length) {
  return allowed_loss({.velocity = axis.velocity, .acceleration = -axis.acceleration},
                      max_acceleration, scale, length);
}

}  // namespace cnc::hal::cpu5::firmware
