#include "motion/axis_ramp.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

namespace {

/// The number x = m + r (m whole, 0 <= r < 1) of units that can be given back one per tick, with
/// the last tick for the rest, while m (m + 1)/2 + r (m + 1) of them add up; 0 for less than none.
double units_given_back(double sum) {
  if (sum <= 0.0) return 0.0;
  const double m = std::floor(0.5 * (std::sqrt(1.0 + 8.0 * sum) - 1.0));
  return m + (sum - 0.5 * m * (m + 1.0)) / (m + 1.0);
}

/// Largest velocity v' >= 0 that an axis may have at the end of this tick, when it may travel
/// `room` further, now moves at v, and later brakes with one constant acceleration of at most a per
/// tick.
///
/// A stop from v' = (m + r) aT with 0 <= r < 1 takes m ticks at a and one for the rest, over
/// aT² (m (m + 2r)/2 + r/2); together with the tick (v + v') T/2 that lies ahead the room needed is
/// vT/2 + aT² (m (m + 1)/2 + r (m + 1)).
double fastest_with_room(double room, double v, double a, double tick) {
  if (std::isinf(room)) return room;
  return a * tick * units_given_back((room - 0.5 * v * tick) / (a * tick * tick));
}

/// Part of the largest change in a tick that is rounding.
constexpr double kRounding = 1e-6;

/// A stop takes fewer ticks than this at the shortest tick and limits a thousand times as low as
/// those of a slow machine.
constexpr int kMostTicks = 100'000;

constexpr int kHalvings = 50;

/// A stop that ends this close to the end of the room uses all of it, mm.
constexpr double kUsedUp = 1e-10;

}  // namespace

AxisState AxisRamp::next(const AxisState& now, double wanted, const Room& room) const {
  return jerk_ > 0.0 ? next_within_jerk(now, wanted, room)
                     : next_within_acceleration(now, wanted, room);
}

bool AxisRamp::nearly_stands(const AxisState& state) const {
  if (jerk_ <= 0.0) return std::abs(state.velocity) <= kRounding * acceleration_ * tick_;
  const double change = kRounding * jerk_ * tick_;
  return std::abs(state.acceleration) <= change && std::abs(state.velocity) <= change * tick_;
}

AxisState AxisRamp::next_within_acceleration(const AxisState& now, double wanted,
                                             const Room& room) const {
  const double v = now.velocity;
  const double up = fastest_with_room(room.top - now.position, v, acceleration_, tick_);
  const double down = fastest_with_room(now.position - room.bottom, -v, acceleration_, tick_);
  const double within = std::min(std::max(wanted, -down), up);
  const double change = acceleration_ * tick_;
  const double next = std::clamp(within, v - change, v + change);
  return {now.position + 0.5 * (v + next) * tick_, next, 0.0};
}

AxisState AxisRamp::after_tick(const AxisState& now, double acceleration) const {
  const double mean = 0.5 * (now.acceleration + acceleration);
  const double way =
      now.velocity * tick_ + (2.0 * now.acceleration + acceleration) * (tick_ * tick_ / 6.0);
  return {now.position + way, now.velocity + mean * tick_, acceleration};
}

/// The acceleration at the end of the tick from which, given back with the full jerk, the velocity
/// ends at `wanted`: from a' = (m + r) jT that takes m + 1 ticks, and with the tick that lies ahead
/// the velocity changes by aT/2 + jT² (m (m + 1)/2 + r (m + 1)).
double AxisRamp::acceleration_towards(const AxisState& now, double wanted) const {
  const double change = jerk_ * tick_;
  const double left = wanted - now.velocity - 0.5 * now.acceleration * tick_;
  const double units = units_given_back(std::abs(left) / (change * tick_));
  const double low = std::max(now.acceleration - change, -acceleration_);
  const double high = std::min(now.acceleration + change, acceleration_);
  return std::clamp(std::copysign(units * change, left), low, high);
}

/// Where a stop that begins now ends; nothing when it leaves the room.
std::optional<double> AxisRamp::stop_within(AxisState state, const Room& room) const {
  if (state.position > room.top || state.position < room.bottom) return std::nullopt;
  for (int i = 0; i < kMostTicks; ++i) {
    if (nearly_stands(state)) return state.position;
    state = after_tick(state, acceleration_towards(state, 0.0));
    if (state.position > room.top || state.position < room.bottom) return std::nullopt;
  }
  return std::nullopt;
}

/// A stop that is to use all of the room is searched for in one tick only: in the next ones it is
/// that very stop which does.
AxisState AxisRamp::next_within_jerk(const AxisState& now, double wanted, const Room& room) const {
  // Outside already it may move, but not further out.
  const Room wider{std::min(room.bottom, now.position), std::max(room.top, now.position)};
  double best = acceleration_towards(now, wanted);
  if (!stop_within(after_tick(now, best), wider)) {
    double bad = best;
    best = acceleration_towards(now, 0.0);
    const double end = bad > best ? wider.top : wider.bottom;
    std::optional<double> stop = stop_within(after_tick(now, best), wider);
    const auto leaves_room = [&] { return stop && std::abs(end - *stop) > kUsedUp; };
    for (int i = 0; i < kHalvings && leaves_room(); ++i) {
      const double middle = 0.5 * (best + bad);
      const auto better = stop_within(after_tick(now, middle), wider);
      (better ? best : bad) = middle;
      if (better) stop = better;
    }
  }
  const AxisState next = after_tick(now, best);
  if (wanted == 0.0 && nearly_stands(next)) return {next.position, 0.0, 0.0};
  return next;
}

}  // namespace cnc::motion
