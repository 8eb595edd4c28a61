// The firmware's numbers: whole ticks, and steps with a binary fraction. No floating point, so
// every processor that runs the core makes the same steps.
//
//   time      ticks of 0.1 us
//   position  int64 in units of 2^-32 step: +-2^29 steps are used (kMaxPosition)
//   velocity  int64 in units of 2^-32 step per tick: one unit is 0.0023 steps/s
//   accel.    int64 in units of 2^-56 step per tick^2: one unit is 0.0014 steps/s^2
//   path time int64 in units of 2^-20 tick: the time that segments are written in
//   scale     int64 in units of 2^-30: path time per time; kFullScale unless the board stops along
//             the path or follows the spindle
//
// The 64-bit products in hermite.cpp hold because a velocity is at most kTopVelocity (500 kHz) and
// a segment at most kMaxSegmentTicks (0.105 s) long; the core checks both before it uses a segment.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cnc::hal::cpu5::firmware {

inline constexpr std::size_t kAxisCount = 6;
/// One value per axis, X Y Z A B C.
template <typename T>
using PerAxis = std::array<T, kAxisCount>;

using Ticks = std::int64_t;
inline constexpr Ticks kTicksPerSecond = 10'000'000;
inline constexpr Ticks kMaxSegmentTicks = Ticks{1} << 20;
/// The shortest segment that keeps its velocity within 1 % when its duration is rounded to ticks.
inline constexpr Ticks kMinSegmentTicks = 100;

using PathTime = std::int64_t;
inline constexpr int kPathFractionBits = 20;
[[nodiscard]] constexpr PathTime path_time(Ticks ticks) { return ticks << kPathFractionBits; }

using TimeScale = std::int64_t;
inline constexpr int kScaleBits = 30;
inline constexpr TimeScale kFullScale = TimeScale{1} << kScaleBits;
/// Of a segment that follows a spindle faster than it was planned for.
inline constexpr TimeScale kTopScale = kFullScale + kFullScale / 4;

using StepPosition = std::int64_t;
using StepVelocity = std::int64_t;
inline constexpr PerAxis<StepVelocity> kStandstill{};
inline constexpr int kFractionBits = 32;
inline constexpr StepPosition kOneStep = StepPosition{1} << kFractionBits;
/// Half the range, so that the way between any two positions fits too.
inline constexpr StepPosition kMaxPosition = StepPosition{1} << 61;

[[nodiscard]] constexpr StepVelocity velocity_of_frequency(std::int64_t hertz) {
  return hertz * kOneStep / kTicksPerSecond;
}
inline constexpr StepVelocity kTopVelocity = velocity_of_frequency(500'000);

using StepAcceleration = std::int64_t;
inline constexpr int kAccelerationBits = 56;
inline constexpr StepAcceleration kTopAcceleration = StepAcceleration{1} << 43;  // 1.2e10 steps/s^2

/// The motor stands on the step nearest to the position; exactly between two, on the upper one.
[[nodiscard]] constexpr std::int64_t nearest_step(StepPosition position) {
  return (position + kOneStep / 2) >> kFractionBits;
}
[[nodiscard]] constexpr StepPosition position_of_step(std::int64_t step) { return step * kOneStep; }

}  // namespace cnc::hal::cpu5::firmware
