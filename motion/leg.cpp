#include "motion/leg.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

namespace {

/// Phases of a straight line last at least this long where there is a choice, so that no setpoint
/// has to be shorter: a lower peak or a softer ramp costs less than this time.
constexpr double kShortestPhase = kShortestSetpoint;

/// Speeds that differ by less than this part are the same.
constexpr double kSameSpeed = 1e-9;

/// What is left of x after braking when it is nothing but rounding, as a part of x before.
constexpr double kStandstill = 1e-9;

double square(double value) { return value * value; }

/// The rest of a straight line: from `speed` over `left` mm to at most `exit_speed`, never above
/// `limit`, with at most `a`.
struct Straight {
  double left;
  double speed;
  double exit_speed;
  double limit;
  double a;

  [[nodiscard]] double ramp_length(double from, double to) const {
    return std::abs(square(from) - square(to)) / (2.0 * a);
  }

  [[nodiscard]] Leg leg(double w, double length, double end_speed) const {
    return {w, length, speed, end_speed};
  }

  /// Changes to `target` within `length` mm.
  [[nodiscard]] Leg ramp(double target, double length) const {
    return leg((square(target) - square(speed)) / (2.0 * length), length, target);
  }

  [[nodiscard]] Leg brake() const {
    const double length = ramp_length(speed, 0.0);
    return length < left ? leg(-a, length, 0.0) : brake_through();
  }

  /// Braking that does not come to its end before the line's, except for rounding.
  [[nodiscard]] Leg brake_through() const {
    const double x = square(speed) - 2.0 * a * left;
    return x > kStandstill * square(speed) ? leg(-a, left, std::sqrt(x)) : ramp(0.0, left);
  }

  /// Braking for the exit has to begin now (or within a microsecond).
  [[nodiscard]] bool exit_is_near() const {
    return speed > exit_speed && ramp_length(speed, exit_speed) >= left - 1e-6 * speed;
  }

  [[nodiscard]] Leg to_exit() const {
    if (ramp_length(speed, exit_speed) <= left * (1.0 + 1e-9)) return ramp(exit_speed, left);
    return brake_through();
  }

  /// Down to a limit that was lowered while moving.
  [[nodiscard]] Leg to_limit() const {
    const double gentle = 0.5 * (speed + limit) * kShortestPhase;
    const double hard = ramp_length(speed, limit);
    const bool gentle_fits = gentle + ramp_length(limit, std::min(limit, exit_speed)) < left;
    return ramp(limit, gentle_fits ? std::max(gentle, hard) : hard);
  }

  /// The highest speed from which the exit can still be met: the limit, or the top of a triangle,
  /// lowered so far that a cruise between them is no shorter than a phase.
  [[nodiscard]] double peak() const {
    const double sum = square(speed) + square(exit_speed);
    const double top = std::sqrt(a * left + 0.5 * sum);
    if (top <= limit) return top;
    const double cruise = left - (square(limit) - 0.5 * sum) / a;
    if (cruise >= limit * kShortestPhase) return limit;
    const double t = a * kShortestPhase;
    return std::min(limit, 0.5 * (std::sqrt(t * t + 4.0 * a * left + 2.0 * sum) - t));
  }

  [[nodiscard]] std::optional<Leg> accelerate() const {
    const double reach = std::sqrt(square(speed) + 2.0 * a * left);
    if (reach <= exit_speed) return leg(a, left, reach);
    const double top = peak();
    if (top <= speed * (1.0 + kSameSpeed)) return std::nullopt;
    const double hard = ramp_length(speed, top);
    const double gentle = 0.5 * (speed + top) * kShortestPhase;
    if (hard >= gentle) return leg(a, hard, top);
    if (gentle + ramp_length(top, exit_speed) <= left) return ramp(top, gentle);
    if (speed > 0.9 * top) return std::nullopt;
    return leg(a, hard, top);
  }

  [[nodiscard]] Leg cruise() const {
    if (speed <= exit_speed * (1.0 + kSameSpeed)) return leg(0.0, left, speed);
    const double gentle = 0.5 * (speed + exit_speed) * kShortestPhase;
    const double until = left - std::max(ramp_length(speed, exit_speed), gentle);
    return until > 1e-6 * speed ? leg(0.0, until, speed) : to_exit();
  }
};

Leg straight_leg(const Straight& way) {
  if (way.exit_is_near()) return way.to_exit();
  if (way.speed > way.limit * (1.0 + kSameSpeed)) return way.to_limit();
  if (const auto leg = way.accelerate()) return *leg;
  return way.cruise();
}

/// The largest w that does not miss the machine's exit.
double machine_w(const Exit& exit, double left, double x) {
  return (exit.machine_x - x) / (2.0 * left);
}

/// A leg of a curved step with w, ending where the step ends or where it stands still.
Leg curved_leg_with(double w, double left, double x) {
  const double exit_x = x + 2.0 * left * w;
  if (exit_x > kStandstill * x) return {w, left, std::sqrt(x), std::sqrt(exit_x)};
  const double length = w < 0.0 ? std::min(left, -x / (2.0 * w)) : left;
  return {w, length, std::sqrt(x), 0.0};
}

/// Down to the feed that was lowered while moving: as hard as possible, but over no less than the
/// shortest setpoint where the limits leave the choice.
Leg slow_down(const Step& step, double done, double x, const Exit& exit) {
  const double left = step.length - done;
  const double excess = x - step.wanted_x;
  const double gentle = -excess / (2.0 * kShortestSetpoint * std::sqrt(x));
  const double bearable = std::min(allowed_w(step, done, x).high, machine_w(exit, left, x));
  const double w = std::min(std::max(hardest_braking(step, done, x), gentle), bearable);
  const double length = w < 0.0 ? excess / (-2.0 * w) : left;
  if (length >= left) return curved_leg_with(w, left, x);
  return {w, length, std::sqrt(x), std::sqrt(step.wanted_x)};
}

/// From rest inside a step at whose end it has to stand again, one constant w would not move at
/// all: half of the acceleration in the manner of a straight line, the other half left to the
/// curvature.
Leg creep(const Step& step, double left, double exit_x) {
  const double limit_x = std::min(step.wanted_x, 0.5 * step.weakest / step.curvature);
  return straight_leg(
      {left, 0.0, std::sqrt(exit_x), std::sqrt(limit_x), 0.5 * largest_w_at_rest(step)});
}

Leg curved_leg(const Step& step, double done, double x, const Exit& exit) {
  const double left = step.length - done;
  if (x <= 0.0 && exit.wanted_x <= 0.0) return creep(step, left, exit.wanted_x);
  if (x > step.wanted_x * (1.0 + kSameSpeed)) return slow_down(step, done, x, exit);
  const Range range = allowed_w(step, done, x);
  const double wanted = (exit.wanted_x - x) / (2.0 * left);
  // Rounding may leave the range empty by a hair; the upper bound is the one that matters then, and
  // what the machine's exit demands comes before everything.
  const double w = std::min(std::max(wanted, range.low), range.high);
  return curved_leg_with(std::min(w, machine_w(exit, left, x)), left, x);
}

}  // namespace

std::optional<Leg> next_leg(const Step& step, double done, double speed, const Exit& exit,
                            bool braking) {
  if (braking || step.wanted_x <= 0.0) {
    if (speed <= 0.0) return std::nullopt;
    const double left = step.length - done;
    if (step.straight) return Straight{left, speed, 0.0, 0.0, step.along}.brake();
    const double x = square(speed);
    // What holds for the rest of the step at once may be softer than what its end demands.
    const double w = std::min(hardest_braking(step, done, x), machine_w(exit, left, x));
    return curved_leg_with(w, left, x);
  }
  if (!step.straight) return curved_leg(step, done, square(speed), exit);
  return straight_leg(
      {step.length - done, speed, std::sqrt(exit.wanted_x), std::sqrt(step.wanted_x), step.along});
}

}  // namespace cnc::motion
