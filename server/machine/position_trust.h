// What is known of where each axis really stands, apart from where it was sent (LNK-4).
//
// The board counts the steps that it makes, not those that a motor follows. An axis that was
// stopped on the spot may have slipped: its count is doubtful. An axis whose count is lost stands
// nobody knows where. Trust is only ever taken away here, except by homing and by the operator's
// word.
//
// Only the axes that a program can move are looked at; the others stay unknown.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/axis.h"
#include "config/error.h"

namespace cnc::server {

/// In the order from good to bad.
enum class Trust : std::uint8_t {
  trusted,   ///< homed, and every step since then made with a ramp
  doubtful,  ///< counted on, but the motor may have slipped or been moved
  unknown,   ///< not homed, or the count is lost
};

/// What takes trust away; the table in position_trust.cpp says how much.
enum class TrustEvent : std::uint8_t {
  stopped_on_the_spot,  ///< the axes were moving: fault, emergency stop, quick stop
  link_lost,            ///< the axes had motion under way: how it ended is not known
  counts_lost,          ///< the board was reset
  steps_lost,           ///< the axes' drives have noticed it
  homing_begun,         ///< until it is done
  drives_off,           ///< they hold the axes no more
};

class PositionTrust {
 public:
  explicit PositionTrust(const AxisArray<bool>& axes) : axes_(axes) {}

  /// Those of `axes` that are trusted less from now on.
  AxisArray<bool> take(TrustEvent event, const AxisArray<bool>& axes);
  void homed(Axis axis);
  /// The operator has checked where the axes stand; none given: all that are not trusted. Refused
  /// for an axis that has never been homed: there is no position to accept.
  [[nodiscard]] Result<std::vector<Axis>> accept(std::vector<Axis> axes);

  [[nodiscard]] Trust operator[](Axis axis) const { return trust_[axis]; }
  [[nodiscard]] const AxisArray<Trust>& all() const { return trust_; }
  /// Trusted or doubtful: those whose limits still mean something.
  [[nodiscard]] AxisArray<bool> known() const;
  [[nodiscard]] bool all_trusted() const;
  /// What is wrong and what to do, for the operator; empty when all axes are trusted.
  [[nodiscard]] std::string advice() const;

 private:
  [[nodiscard]] std::vector<Axis> axes_with(Trust trust) const;

  AxisArray<bool> axes_;
  AxisArray<Trust> trust_ = AxisArray<Trust>::filled(Trust::unknown);
  AxisArray<bool> once_homed_{};
};

[[nodiscard]] AxisArray<bool> only(Axis axis);
/// What has happened, as the beginning of a message.
[[nodiscard]] std::string_view sentence_of(TrustEvent event);
/// "X", "X and Y", "X, Y and Z".
[[nodiscard]] std::string names_of(const std::vector<Axis>& axes);

}  // namespace cnc::server
