#include "hal/cpu5/firmware/hermite.h"

#include <algorithm>
#include <bit>

namespace cnc::hal::cpu5::firmware {
namespace {

// T v is at most 52429 steps (kTopVelocity, kMaxSegmentTicks), the polynomial's three coefficients
// in u at most 1, 6 and 4 times that; 2^k / T <= 2 makes them 1 * 2, 6 * 4 and 4 * 8 times as much
// at most. The largest value formed of them, six times the last and twice the middle, is below
// 250 * 52429 * 2^38 < 2^62.
constexpr int kCoefficientBits = 38;
constexpr int kFinerBits = kCoefficientBits - kFractionBits;
constexpr int kPartBits = 32;

constexpr StepPosition in_position_units(std::int64_t value) { return value >> kFinerBits; }

// value * part / 2^32, without a product of more than 64 bits.
constexpr std::int64_t times_part(std::int64_t value, std::uint32_t part) {
  const std::int64_t high = value >> kPartBits;
  const auto low = static_cast<std::uint32_t>(value);
  return high * std::int64_t{part} +
         static_cast<std::int64_t>(std::uint64_t{low} * part >> kPartBits);
}

// Multiplies by 2^k / T, which is more than 1 and at most 2: the part above 1 as a fraction of 64
// bits, found by a long division in two digits.
class Stretch {
 public:
  Stretch(int power, Ticks duration) {
    const auto divisor = static_cast<std::uint64_t>(duration);
    const std::uint64_t above = ((std::uint64_t{1} << power) - divisor) << kPartBits;
    whole_ = above >= divisor << kPartBits;  // T is a power of two itself
    high_ = static_cast<std::uint32_t>(above / divisor);
    low_ = static_cast<std::uint32_t>((above % divisor << kPartBits) / divisor);
  }
  std::int64_t operator()(std::int64_t value) const {
    const std::int64_t part = times_part(value, high_) + (times_part(value, low_) >> kPartBits);
    return value + (whole_ ? value : part);
  }

 private:
  bool whole_;
  std::uint32_t high_;
  std::uint32_t low_;
};

constexpr std::int64_t shifted(std::int64_t value, int bits) {
  return bits < 0 ? value >> -bits : value << bits;
}

// distance / speed, within 2^-15 of it. Of a speed below 2^32 the highest 16 bits count, so that
// one division of 32 bits does: it is made for every step.
constexpr PathTime time_for(StepPosition distance, StepVelocity speed) {
  const auto bits = static_cast<std::uint32_t>(speed);
  const int zeros = std::countl_zero(bits);
  const std::uint32_t inverse = 0xFFFF'FFFFU / (bits << zeros >> 16);  // 2^48 / (speed 2^zeros)
  return shifted(distance * std::int64_t{inverse}, zeros - (48 - kPathFractionBits));
}

constexpr std::int64_t magnitude(std::int64_t value) { return value < 0 ? -value : value; }
constexpr std::int64_t larger(std::int64_t a, std::int64_t b) { return a > b ? a : b; }

}  // namespace

Cubic::Cubic(const AxisMotion& motion)
    : power_(static_cast<int>(std::bit_width(static_cast<std::uint32_t>(motion.duration)))) {
  const Stretch stretch(power_, motion.duration);
  const StepPosition start_way = motion.start_velocity * motion.duration;
  const StepPosition end_way = motion.end_velocity * motion.duration;
  const StepPosition quadratic = 3 * motion.distance - 2 * start_way - end_way;
  const StepPosition cubic = start_way + end_way - 2 * motion.distance;
  linear_ = motion.start_velocity << (power_ + kFinerBits);
  quadratic_ = stretch(stretch(quadratic << kFinerBits));
  cubic_ = stretch(stretch(stretch(cubic << kFinerBits)));
}

std::uint32_t Cubic::part_of_power(Ticks elapsed) const {
  return static_cast<std::uint32_t>(elapsed) << (kPartBits - power_);
}

StepPosition Cubic::distance_after(Ticks elapsed) const {
  const std::uint32_t part = part_of_power(elapsed);
  std::int64_t value = times_part(cubic_, part) + quadratic_;
  value = times_part(value, part) + linear_;
  return in_position_units(times_part(value, part));
}

StepPosition Cubic::distance_at(PathTime elapsed) const {
  constexpr PathTime kFractionMask = path_time(1) - 1;
  const Ticks tick = elapsed >> kPathFractionBits;
  const PathTime fraction = elapsed & kFractionMask;
  const StepPosition here = distance_after(tick);
  if (fraction == 0) return here;
  return here + ((distance_after(tick + 1) - here) * fraction >> kPathFractionBits);
}

StepVelocity Cubic::velocity_after(Ticks elapsed) const {
  const std::uint32_t part = part_of_power(elapsed);
  const std::int64_t bend = 3 * times_part(cubic_, part) + 2 * quadratic_;
  return in_position_units(times_part(bend, part) + linear_) >> power_;
}

StepAcceleration Cubic::acceleration_after(Ticks elapsed) const {
  const std::int64_t bend = 6 * times_part(cubic_, part_of_power(elapsed)) + 2 * quadratic_;
  return shifted(bend, kAccelerationBits - kCoefficientBits - 2 * power_);
}

// Newton's method from tick to tick, kept between two ticks of which the earlier is known to come
// too early: where the axis turns round, and the slope leads nowhere, it halves that interval.
PathTime Cubic::moment_of(const Passage& passage) const {
  const auto forwards = [&](std::int64_t value) { return passage.upwards ? value : -value; };
  Ticks early = passage.after >> kPathFractionBits;
  Ticks late = passage.before >> kPathFractionBits;
  Ticks tick = early;
  while (true) {
    const StepPosition missing = forwards(passage.distance - distance_after(tick));
    const StepVelocity speed = forwards(velocity_after(tick));
    const PathTime way = speed > 0 ? time_for(missing, speed) : 0;
    if (magnitude(missing) <= speed && speed > 0) {
      return std::clamp(path_time(tick) + way, passage.after, passage.before);
    }
    (missing > 0 ? early : late) = tick;
    if (late - early <= 1) return std::clamp(path_time(late), passage.after, passage.before);
    const Ticks next = tick + (way >> kPathFractionBits);
    tick = early < next && next < late ? next : early + (late - early) / 2;
  }
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
