#include "hal/cpu5/firmware/hermite.h"

namespace cnc::hal::cpu5::firmware {
namespace {

// Coefficients drop 8 of the 32 fraction bits so that a coefficient times a time fits 64 bits. With
// |T v| <= 52429 steps (kTopVelocity, kMaxSegmentTicks) every value that distance_after()
// multiplies is at most 7 * 52429 * 2^24 < 2^42.5, and the time is at most 2^20.
constexpr int kDroppedBits = 8;

constexpr std::int64_t magnitude(std::int64_t value) { return value < 0 ? -value : value; }
constexpr std::int64_t larger(std::int64_t a, std::int64_t b) { return a > b ? a : b; }

}  // namespace

Cubic::Cubic(const AxisMotion& motion) : duration_(motion.duration) {
  const StepPosition start_way = motion.start_velocity * motion.duration;
  const StepPosition end_way = motion.end_velocity * motion.duration;
  linear_ = start_way >> kDroppedBits;
  quadratic_ = (3 * motion.distance - 2 * start_way - end_way) >> kDroppedBits;
  cubic_ = (start_way + end_way - 2 * motion.distance) >> kDroppedBits;
}

// Horner's rule. The division by T instead of a stored 1/T costs a little time and keeps the result
// exact to the last bit but one in each of its three steps.
StepPosition Cubic::distance_after(Ticks elapsed) const {
  std::int64_t value = cubic_ * elapsed / duration_;
  value = (value + quadratic_) * elapsed / duration_;
  value = (value + linear_) * elapsed / duration_;
  return value * (StepPosition{1} << kDroppedBits);
}

StepPosition Cubic::distance_at(PathTime elapsed) const {
  constexpr PathTime kFractionMask = path_time(1) - 1;
  const Ticks tick = elapsed >> kPathFractionBits;
  const PathTime fraction = elapsed & kFractionMask;
  const StepPosition here = distance_after(tick);
  if (fraction == 0) return here;
  return here + ((distance_after(tick + 1) - here) * fraction >> kPathFractionBits);
}

// p'(u) / T. The product with the time is T (p'(u) - p'(0)), so the bound on the speed holds it
// below 2^61.
StepVelocity Cubic::velocity_after(Ticks elapsed) const {
  const std::int64_t bend = 3 * (cubic_ * elapsed / duration_) + 2 * quadratic_;
  const std::int64_t slope = bend * elapsed / duration_ + linear_;
  return slope * (std::int64_t{1} << kDroppedBits) / duration_;
}

// p''(u) / T^2, where |p''| <= 36 T kTopVelocity < 2^45. Half of the missing 32 bits come in before
// either division.
StepAcceleration Cubic::acceleration_after(Ticks elapsed) const {
  constexpr std::int64_t kHalf = std::int64_t{1}
                                 << (kAccelerationBits - kFractionBits + kDroppedBits) / 2;
  const std::int64_t bend = 6 * (cubic_ * elapsed / duration_) + 2 * quadratic_;
  return bend * kHalf / duration_ * kHalf / duration_;
}

// The velocity is a parabola with the Bernstein coefficients v0, m = 3 D / T - v0 - v1, v1. Its
// vertex lies inside the segment when v0 - m and v1 - m have the same sign; there the velocity is
// (v0 v1 - m^2) / ((v0 - m) + (v1 - m)). The square needs four bits less: |m| <= 5 kTopVelocity <
// 2^31.
StepVelocity peak_speed(const AxisMotion& motion) {
  constexpr int kSquareBits = 4;
  const StepVelocity middle =
      3 * motion.distance / motion.duration - motion.start_velocity - motion.end_velocity;
  const std::int64_t m = middle >> kSquareBits;
  const std::int64_t v0 = motion.start_velocity >> kSquareBits;
  const std::int64_t v1 = motion.end_velocity >> kSquareBits;

  const StepVelocity at_ends =
      larger(magnitude(motion.start_velocity), magnitude(motion.end_velocity));
  const bool vertex_inside = (v0 < m && v1 < m) || (v0 > m && v1 > m);
  if (!vertex_inside) return at_ends;
  const StepVelocity at_vertex = (v0 * v1 - m * m) / ((v0 - m) + (v1 - m));
  return larger(at_ends, magnitude(at_vertex) << kSquareBits);
}

}  // namespace cnc::hal::cpu5::firmware
