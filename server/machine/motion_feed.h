// The last stage before the link: setpoints of the machine become segments of its motors.
//
// Checks every setpoint against the limits of the axes, adds what motors have to do more
// (motion::Compensation), checks the sum against the limits of the motors, and numbers the
// segments. Knows how many seconds of motion are under way and which move the board executes just
// now. What is under way and not begun can be replaced: numbers go on, so that each of them means
// one segment for ever. The board is told their lower halves, which go round. All positions here,
// those of the board's status included, are the machine's; only the link and what is behind it
// count motors. Executor thread only.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "config/machine_config.h"
#include "motion/compensation.h"
#include "motion/planner.h"
#include "motion/setpoint_check.h"
#include "server/link/link.h"

namespace cnc::server {

/// Where the board is in what it was given.
struct Executing {
  motion::MoveTag tag;
  double feed_limit = 0.0;  ///< programmed feed, mm/s; 0 = rapid
  Position velocity;
};

/// What became of a cut.
enum class CutAnswer : std::uint8_t { none, pending, taken, late };

class MotionFeed {
 public:
  /// Of a segment: for ever, from 1. The board is told the lower half; where that would be 0, which
  /// says "none" there, a number is left out.
  using Id = std::uint64_t;
  /// A steady clock in seconds: what computing takes. Without one, as in virtual time, it takes
  /// none.
  using Clock = std::function<double()>;
  MotionFeed(Link& link, const config::MachineConfig& config, Clock clock = {});

  /// Reads the link's newest status; at the beginning of each cycle of the machine.
  void update();
  [[nodiscard]] const hal::ControllerStatus& board() const { return status_.board; }

  /// True while less than `least` seconds of motion are under way, or less than lead() of what is,
  /// and the link has room.
  [[nodiscard]] bool wants_more(double least = 0.0) const;
  /// Motion that the board needs while the axes move at up to `speed`, s: it goes on for a while
  /// before it takes the host for lost, and stops along what it has of the path.
  [[nodiscard]] double lead(const Position& speed) const;
  /// What a plan may use of the axes, and where they may be: infinite for those that are not
  /// `limited`.
  [[nodiscard]] const motion::AxisLimits& limits() const { return compensation_.machine_limits(); }
  [[nodiscard]] motion::Extents travel(const AxisArray<bool>& limited) const;
  /// At rest, before a motion begins: which axes have to stay within their travel.
  void begin_motion(const AxisArray<bool>& limited);
  /// Sends a setpoint, checked once more. `change` takes effect at the tick at which it begins.
  /// A motion that begins at rest is held back until it ends at rest, or hand_over(): the board must
  /// not come to the end of a part of it while the rest is still being planned.
  Result<void> emit(const motion::Setpoint& setpoint, const hal::OutputChange& change = {});
  /// At the end of each cycle.
  void hand_over() { link_.hand_over(); }

  /// Segments that the board has not begun.
  [[nodiscard]] std::size_t under_way() const;
  /// Those of them that a cut would replace in time: all behind the first one that ends later than
  /// a cut needs to reach the board, and as much later as the last one took from here to
  /// commit_cut(). None while the path follows the spindle, or the board stops along it, or the
  /// link has no room for new ones. Behind a late cut these are in any case the segments that the
  /// board never had: the link has dropped them. Reads the newest status.
  [[nodiscard]] std::size_t replaceable();
  /// The last `count` segments are void, commanded() is where the one before them ends, and what is
  /// emitted until commit_cut() travels with the cut. Not while an answer is pending.
  void begin_cut(std::size_t count);
  void commit_cut();
  /// Taken and late are answered until the next cut; after a late one what was void counts again,
  /// and the board takes nothing before the next begin_cut().
  [[nodiscard]] CutAnswer cut_answer();
  /// How fast the last segment ends that is not void.
  [[nodiscard]] const Position& end_velocity() const { return sent(last_id_).end_velocity; }
  [[nodiscard]] const Position& end_acceleration() const { return sent(last_id_).end_acceleration; }

  /// The board has answered everything that was sent.
  [[nodiscard]] bool all_told() const {
    return waiting_.empty() && status_.items_done == link_.pushed();
  }
  /// Everything emitted and every command sent has been executed, and the machine stands.
  [[nodiscard]] bool at_rest() const;
  /// The board says that it moves, or has more to execute, behind the end of all that it was given.
  [[nodiscard]] bool board_goes_on() const;
  /// A quick stop is under way: where the machine will stand is not known yet.
  [[nodiscard]] bool stopping() const { return position_unknown_; }
  [[nodiscard]] Executing executing() const;
  /// Axes whose motors the board was moving in the segment it executes, or in which it has been
  /// stopped, as long as that stop has not been accepted; and those that have not come to rest yet.
  [[nodiscard]] AxisArray<bool> axes_in_motion() const;
  /// Those, and all that would still move in what was sent: where the board may be by now when it
  /// is not heard any more.
  [[nodiscard]] AxisArray<bool> axes_under_way() const;
  /// The axes that these motors drive, slaves their masters'.
  [[nodiscard]] AxisArray<bool> axes_of(const AxisArray<bool>& motors) const;
  /// Id of the last segment emitted that is not void, and whether the board has finished the
  /// segment `id`.
  [[nodiscard]] Id last_id() const { return last_id_; }
  [[nodiscard]] bool executed(Id id) const {
    return is_past(id) || (executing_id_ == id && status_.board.executing_phase >= 1.0);
  }
  /// Id of the segment that the next setpoint becomes, or begins with, and whether the board has
  /// begun the segment `id`. One that waits for the spindle has not.
  [[nodiscard]] Id next_id() const;
  [[nodiscard]] bool begun(Id id) const {
    return is_past(id) || (executing_id_ == id && status_.board.executing_phase > 0.0);
  }

  /// Where the last setpoint ended: the start of the next.
  [[nodiscard]] const Position& commanded() const { return commanded_; }

  /// At rest: the height map that Z follows from now on, none to end it. Z goes there at once;
  /// limits() change. Refused where that would lead out of Z's travel.
  Result<void> use_surface(std::shared_ptr<const motion::HeightSurface> surface);
  [[nodiscard]] const motion::HeightSurface* surface() const { return compensation_.surface(); }

  /// Behind everything sent before; where the link has no room for it, in one of the next cycles.
  void send(const LinkItem& item);
  /// What is sent from now on is meant for the board as it is in the present session. Segments are
  /// numbered on behind what another host may have given it.
  void join_session();
  /// Is called with every setpoint that leaves.
  void set_listener(std::function<void(const motion::Setpoint&)> listener) {
    listener_ = std::move(listener);
  }
  /// Is called with the number of setpoints, the last ones, that are not executed after all. When a
  /// cut was late they are told once more.
  void set_cut_listener(std::function<void(std::size_t)> listener) {
    cut_listener_ = std::move(listener);
  }
  /// Is called with what the motors get for it.
  void set_motor_listener(std::function<void(const motion::Setpoint&)> listener) {
    motor_listener_ = std::move(listener);
  }
  /// Is called when the commanded position becomes another than the last setpoint's.
  void set_restart_listener(std::function<void(const Position&)> listener) {
    restart_listener_ = std::move(listener);
  }
  /// Pulses stop at once; when the board stands, what it counted becomes the commanded position.
  void quick_stop();
  /// After a stop that was not planned: take the board's position as the commanded one.
  void accept_board_position();
  /// At rest only: the present place of the axis has machine position `position`.
  void set_position(Axis axis, double position);

 private:
  static constexpr Id kAnyId = std::numeric_limits<Id>::max();

  struct Sent {
    Id id = 0;
    Id before = 0;              // id of the segment from whose end it goes on
    std::uint64_t ordinal = 0;  // of the setpoint; settling segments have that of the one before
    double end_time = 0.0;      // on the time line of everything emitted
    double duration = 0.0;
    Position end;
    Position start_velocity;
    Position end_velocity;
    Position end_acceleration;
    AxisArray<bool> moves{};
    motion::MoveTag tag;
    double feed_limit = 0.0;
    Position motors;  // at its end, like all that follows
    Position motor_velocity;
    motion::Compensation::State state;
  };
  // More than the link and the board hold together, and as much again that is void.
  static constexpr std::size_t kHistory = 16384;

  struct Cut {
    std::uint64_t item = 0;  // of the link
    Id kept_id = 0;
    Id last_id = 0;  // before it
    CutAnswer answer = CutAnswer::none;
    Id board_end = kAnyId;  // behind late ones: the board has the path up to here
  };

  [[nodiscard]] const Sent& sent(Id id) const { return history_[id % kHistory]; }
  [[nodiscard]] Id id_of(std::uint32_t number) const;
  [[nodiscard]] bool is_past(Id id) const { return id <= void_id_ || executing_id_ > id; }
  [[nodiscard]] double executed_time() const;
  [[nodiscard]] Position fastest_under_way() const;
  void add_moves_up_to(Id id, AxisArray<bool>& motors) const;
  [[nodiscard]] bool has_room() const;
  bool send_waiting();
  void revoke_cut();
  void go_on_behind(Id id);
  [[nodiscard]] const motion::Compensation::State& state_of_board() const;
  Result<void> push(const motion::Setpoint& setpoint, const motion::Setpoint& motors,
                    std::uint64_t ordinal, const hal::OutputChange& change = {});
  Result<void> settle();
  void read_status();
  void translate(hal::EventLatch& latch, hal::EventLatch& known) const;
  void accept_motors(const Position& motors);

  Link& link_;
  const config::MachineConfig& config_;
  Clock clock_;
  motion::Compensation compensation_;
  motion::SetpointCheck check_;
  motion::SetpointCheck motor_check_;
  std::function<void(const motion::Setpoint&)> listener_;
  std::function<void(std::size_t)> cut_listener_;
  std::function<void(const motion::Setpoint&)> motor_listener_;
  std::function<void(const Position&)> restart_listener_;
  LinkStatus status_;
  Id executing_id_ = 0;  // of its board, if the segment is one of ours
  std::deque<LinkItem> waiting_;
  std::vector<Sent> history_ = std::vector<Sent>(kHistory);
  Id newest_id_ = 0;  // the next segment has the next
  Id last_id_ = 0;    // of those that are not void
  Cut cut_;
  double patience_ = 1.0;    // factor of the time that a cut gets: more after a late one
  double asked_at_ = 0.0;    // by the clock: replaceable()
  double replanning_ = 0.0;  // s, from there to commit_cut(), of the last cuts
  Id void_id_ = 0;           // up to here nothing is executed any more
  motion::Compensation::State void_state_;  // of the machine that stands there
  Position commanded_;
  Position fastest_;               // speeds of the axes in what is under way, at the most
  Position motors_;                // of the board, as counted
  hal::EventLatch index_latch_;    // the newest that has been translated
  hal::EventLatch estop_latch_;    // likewise
  double moved_at_ = 0.0;          // board time at which it was last seen in motion
  Id stopped_id_ = 0;              // up to here any stop has been accepted
  bool position_unknown_ = false;  // a quick stop is under way
};

}  // namespace cnc::server
