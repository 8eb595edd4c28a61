// How fast the path is driven: a plan of speed over the known part of the path, and the motion
// along it. There is one without and one with limits of jerk.
//
// Pieces of the path are appended while the motion runs; the plan always ends in a standstill at
// the end of what is known. Places that the motion has passed stay until they are forgotten, so
// that it can be sent back to them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "motion/jerk_plan.h"
#include "motion/limits.h"
#include "motion/overrides.h"
#include "motion/piece.h"
#include "motion/setpoint.h"
#include "motion/track.h"

namespace cnc::motion {

/// Where the motion is: each kind of profile has its own notion, and gets back what it gave.
using ProfilePlace = std::variant<Place, MotionPlace>;

class Profile {
 public:
  Profile() = default;
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;
  virtual ~Profile() = default;

  /// Enough path is known for the present, or memory is used up; and some more, so that it pays to
  /// come back later with many pieces at once.
  [[nodiscard]] virtual bool sufficient() const = 0;
  [[nodiscard]] virtual bool well_stocked() const = 0;
  /// Takes in what waits of the last piece; true when none is left.
  virtual bool extend() = 0;
  /// A piece that begins where the last one ends. Only after extend() returned true; may allocate.
  virtual void append(const Piece& piece) = 0;
  /// Many pieces have been appended.
  virtual void plan() = 0;
  /// The machine shall stand still at the present end, whatever comes.
  virtual void stop_at_end() = 0;
  virtual void set_overrides(const Overrides& overrides) = 0;
  virtual void clear() = 0;

  /// Nothing is left to be driven.
  [[nodiscard]] virtual bool empty() const = 0;
  [[nodiscard]] virtual bool standing() const = 0;
  /// Plans what is due; to be called before place() and next().
  virtual void prepare(bool held) = 0;
  /// The next piece of motion, braking along the path to a standstill if `held`; nothing when it
  /// stands and is to stay so, or has nothing to drive.
  [[nodiscard]] virtual std::optional<Setpoint> next(bool held) = 0;
  /// Moves on within the present move, for predictions; nothing when it stands. After
  /// prepare(false).
  [[nodiscard]] virtual std::optional<Stretch> skip() = 0;
  [[nodiscard]] virtual Position position() const = 0;
  /// Seconds to the end of what has been appended: exact as far as it is planned.
  [[nodiscard]] virtual double time_to_end() const = 0;

  [[nodiscard]] virtual ProfilePlace place() const = 0;
  virtual void go_back(const ProfilePlace& place) = 0;
  virtual void forget_before(const ProfilePlace& place) = 0;
  /// How far the motion may be ahead of the oldest place that is not forgotten: whether there is
  /// room for the next setpoint too.
  [[nodiscard]] virtual bool keeps_too_much(const ProfilePlace& oldest) const = 0;
  [[nodiscard]] virtual bool can_keep_more(const ProfilePlace& oldest) const = 0;

  /// Between go_back() and the decision whether it counts, what is drawn must be possible without
  /// more path.
  [[nodiscard]] virtual bool can_go_on_alone() const = 0;
  /// The plan shall be again what it is now if revert() follows.
  virtual void save() {}
  virtual void revert(const ProfilePlace& place) = 0;
};

struct PlannerSettings;

/// The kind that the limits ask for.
[[nodiscard]] std::unique_ptr<Profile> make_profile(const PlannerSettings& settings);

}  // namespace cnc::motion
