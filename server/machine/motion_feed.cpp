#include "server/machine/motion_feed.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

#include "server/job/settings.h"

namespace cnc::server {
namespace {

/// What the board may have less than what was sent, s: a cycle of the machine and two of the link
/// late.
constexpr double kOnItsWay = 0.02;

/// Room kept in the link for commands: outputs, latches, faults to clear.
constexpr std::size_t kReserve = 64;
/// Of which commands leave so much for a cut, and what then settles.
constexpr std::size_t kCutReserve = 16;

/// A motor that is sent no further than this stands, mm or degrees: positions that were worked back
/// from what it counts differ in their last digits.
constexpr double kStill = 1e-9;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Time that an axis needs to come to rest behind the last pulse of its motor, s.
constexpr double kSettling = 0.1;

/// Two motors of an axis that stop together are apart by less than this many steps of theirs.
constexpr double kSlaveTolerance = 2.0;

Position slave_tolerance(const config::MachineConfig& config) {
  Position tolerance;
  for (const Axis motor : kAllAxes)
    tolerance[motor] = kSlaveTolerance / std::abs(config.axes[motor].steps_per_unit);
  return tolerance;
}

/// Of the motors of the limited axes; more by what compensation may add beyond the ends.
motion::Extents motor_travel(const config::MachineConfig& config,
                             const motion::Compensation& compensation,
                             const AxisArray<bool>& limited) {
  motion::Extents travel{Position::filled(-kInfinite), Position::filled(kInfinite)};
  for (const Axis motor : kAllAxes) {
    const Axis axis = compensation.kinematics().axis_of(motor);
    if (!limited[axis] || !config.axes[axis].programmable()) continue;
    const double skew = compensation.kinematics().skew(motor);
    travel.min[motor] = config.axes[axis].negative_limit + skew - compensation.reach(motor);
    travel.max[motor] = config.axes[axis].positive_limit + skew + compensation.reach(motor);
  }
  return travel;
}

/// Compensation adds to the jerk of the plan; only the plan is held to that limit.
motion::AxisLimits motor_check_limits(const config::MachineConfig& config) {
  motion::AxisLimits limits = motor_limits(config);
  limits.max_jerk = {};
  return limits;
}

Position end_acceleration_of(const motion::Setpoint& setpoint, const Position& position,
                             const Position& velocity) {
  Position acceleration;
  for (const Axis axis : kAllAxes) {
    acceleration[axis] = motion::cubic_of(axis, position, velocity, setpoint).end_acceleration();
  }
  return acceleration;
}

}  // namespace

MotionFeed::MotionFeed(Link& link, const config::MachineConfig& config, Clock clock)
    : link_(link),
      config_(config),
      clock_(std::move(clock)),
      compensation_(compensation_settings(config)),
      check_(limits(), travel({}), Position{}),
      motor_check_(motor_check_limits(config), travel({}), Position{}),
      void_state_(compensation_.state()) {
  history_[0].state = void_state_;
}

void MotionFeed::update() {
  send_waiting();
  read_status();
  fastest_ = fastest_under_way();
  if (position_unknown_ && !status_.board.moving && all_told()) accept_board_position();
}

/// In the compensation's state at the end of what the board executes.
const motion::Compensation::State& MotionFeed::state_of_board() const {
  const Id id = executing_id_;
  return id > void_id_ && sent(id).id == id ? sent(id).state : void_state_;
}

/// Of the numbers that were given the newest with this lower half; 0: none of ours.
MotionFeed::Id MotionFeed::id_of(std::uint32_t number) const {
  constexpr Id kCircle = Id{1} << 32U;
  if (number == 0) return 0;
  const Id id = newest_id_ / kCircle * kCircle + number;
  if (id <= newest_id_) return id;
  return id < kCircle ? 0 : id - kCircle;
}

MotionFeed::Id MotionFeed::next_id() const {
  const Id next = newest_id_ + 1;
  return static_cast<std::uint32_t>(next) == 0 ? next + 1 : next;
}

void MotionFeed::send(const LinkItem& item) {
  const bool has_room = send_waiting() && link_.space() > kCutReserve;
  if (!has_room || !link_.push(item)) waiting_.push_back(item);
}

/// True: nothing waits any more.
bool MotionFeed::send_waiting() {
  while (!waiting_.empty() && link_.space() > kCutReserve && link_.push(waiting_.front()))
    waiting_.pop_front();
  return waiting_.empty();
}

/// What another host has made the board execute last ends here, as far as this one knows.
void MotionFeed::join_session() {
  send(JoinSession{status_.board.sessions});
  const Id before = status_.board.executing_id;
  if (before <= newest_id_) return;
  Sent standing = sent(last_id_);
  standing.id = before;
  standing.before = last_id_;
  standing.duration = 0.0;
  standing.moves = {};
  history_[before % kHistory] = standing;
  newest_id_ = last_id_ = executing_id_ = before;
}

/// The board counts motors; from here on its positions are the machine's.
void MotionFeed::read_status() {
  const hal::ControllerStatus& before = status_.board;
  const std::pair place_before{before.executing_id, before.executing_phase};
  status_ = link_.status();
  hal::ControllerStatus& board = status_.board;
  if (std::pair{board.executing_id, board.executing_phase} != place_before) moved_at_ = board.time;
  executing_id_ = id_of(board.executing_id);
  const motion::Compensation::State& state = state_of_board();
  motors_ = board.position;
  board.position = compensation_.machine_at(motors_, state);
  board.probe_latch.position = compensation_.machine_at(board.probe_latch.position, state);
  for (const Axis axis : kAllAxes) {
    hal::Latch& latch = board.home_latch[axis];
    Position motors = motors_;
    motors[axis] = latch.position;
    if (latch.caught) latch.position = compensation_.machine_at(motors, state)[axis];
  }
  translate(board.index_latch, index_latch_);
  translate(board.estop_latch, estop_latch_);
}

/// Once: it stays what it was in the compensation's state of its own moment.
void MotionFeed::translate(hal::EventLatch& latch, hal::EventLatch& known) const {
  if (latch.count != known.count || latch.time != known.time) {
    latch.position = compensation_.machine_at(latch.position, state_of_board());
    known = latch;
  }
  latch = known;
}

bool MotionFeed::wants_more(double least) const {
  return sent(last_id_).end_time - executed_time() < std::max(least, lead(fastest_)) && has_room();
}

bool MotionFeed::has_room() const { return waiting_.empty() && link_.space() > kReserve; }

/// An axis that the plan brakes leaves the board nothing to brake harder with: axes that come to
/// rest one after the other need the sum of their times. A ramp in whole setpoints may take two
/// more.
double MotionFeed::lead(const Position& speed) const {
  double lead =
      config_.connection.host_timeout + kOnItsWay + 2.0 * config_.trajectory.interpolation_time;
  for (const Axis axis : kAllAxes) lead += motion::braking_time(limits(), axis, speed[axis]);
  return lead;
}

void MotionFeed::begin_motion(const AxisArray<bool>& limited) {
  check_ = motion::SetpointCheck(limits(), travel(limited), commanded_);
  motor_check_ = motion::SetpointCheck(motor_check_limits(config_),
                                       motor_travel(config_, compensation_, limited),
                                       compensation_.motors_at(commanded_));
}

/// With a height map Z keeps away from its ends by what the map may add.
motion::Extents MotionFeed::travel(const AxisArray<bool>& limited) const {
  motion::Extents travel{Position::filled(-kInfinite), Position::filled(kInfinite)};
  for (const Axis axis : kAllAxes) {
    if (!limited[axis] || !config_.axes[axis].programmable()) continue;
    travel.min[axis] = config_.axes[axis].negative_limit;
    travel.max[axis] = config_.axes[axis].positive_limit;
  }
  if (const motion::HeightSurface* map = surface()) {
    travel.min[Axis::Z] -= map->lowest();
    travel.max[Axis::Z] -= map->highest();
  }
  return travel;
}

Result<void> MotionFeed::emit(const motion::Setpoint& setpoint, const hal::OutputChange& change) {
  if (auto checked = check_.check(setpoint); !checked) return checked;
  const motion::Setpoint motors = compensation_.apply(setpoint);
  if (auto pushed = push(setpoint, motors, sent(last_id_).ordinal + 1, change); !pushed)
    return pushed;
  return setpoint.velocity == Position{} ? settle() : Result<void>{};
}

/// Where the machine stands, what compensation has begun is brought to its end.
Result<void> MotionFeed::settle() {
  while (const auto motors = compensation_.settle()) {
    motion::Setpoint standing;
    standing.duration = motors->duration;
    standing.position = commanded_;
    standing.tag = sent(last_id_).tag;
    if (auto pushed = push(standing, *motors, sent(last_id_).ordinal); !pushed) return pushed;
  }
  return {};
}

Result<void> MotionFeed::push(const motion::Setpoint& setpoint, const motion::Setpoint& motors,
                              std::uint64_t ordinal, const hal::OutputChange& change) {
  if (auto checked = motor_check_.check(motors); !checked) return checked;
  // What the board has not executed has to be remembered. So many more have become void by cuts
  // that were late, one after the other, as no board needs that makes sense.
  if (next_id() - std::max(executing_id_, void_id_) >= kHistory)
    return fail(ErrorCode::motion_fault,
                "The board calls every change of the path late, or executes none of it.");
  const Sent& before = sent(last_id_);
  Sent next{.id = next_id(),
            .before = before.id,
            .ordinal = ordinal,
            .end_time = before.end_time + setpoint.duration,
            .duration = setpoint.duration,
            .end = setpoint.position,
            .start_velocity = before.end_velocity,
            .end_velocity = setpoint.velocity,
            .end_acceleration = end_acceleration_of(setpoint, commanded_, before.end_velocity),
            .tag = setpoint.tag,
            .feed_limit = setpoint.feed_limit,
            .motors = motors.position,
            .motor_velocity = motors.velocity,
            .state = compensation_.state()};
  for (const Axis axis : kAllAxes)
    next.moves[axis] = std::abs(motors.position[axis] - before.motors[axis]) > kStill ||
                       before.motor_velocity[axis] != 0.0 || motors.velocity[axis] != 0.0;
  const motion::MoveTag& tag = setpoint.tag;
  const hal::Segment segment{.id = static_cast<std::uint32_t>(next.id),
                             .duration = setpoint.duration,
                             .position = motors.position,
                             .velocity = motors.velocity,
                             .wait_for_index = tag.begins_at_index && tag.id != before.tag.id,
                             .spindle_speed = tag.spindle_speed,
                             .change = change};
  if (before.motor_velocity == Position{} && motors.velocity != Position{}) link_.hold_back();
  if (!send_waiting() || !link_.push(segment))
    return fail(ErrorCode::internal_error, "The link's queue is full; wants_more() was not asked.");
  if (motors.velocity == Position{}) link_.hand_over();
  history_[next.id % kHistory] = next;
  last_id_ = newest_id_ = next.id;
  commanded_ = setpoint.position;
  for (const Axis axis : kAllAxes)
    fastest_[axis] = std::max(fastest_[axis], std::abs(setpoint.velocity[axis]));
  if (listener_) listener_(setpoint);
  if (motor_listener_) motor_listener_(motors);
  return {};
}

std::size_t MotionFeed::under_way() const {
  const std::uint64_t last = sent(last_id_).ordinal;
  const Sent& executing = sent(executing_id_);
  const bool known = executing.id == executing_id_ && executing.ordinal <= last;
  return known ? static_cast<std::size_t>(last - executing.ordinal) : 0;
}

/// Two exchanges lie between a status and the board's taking what was decided on it, at the most:
/// the one under way, and the next. And threads do not wake up to the microsecond.
std::size_t MotionFeed::replaceable() {
  constexpr double kLatest = 0.001;
  if (clock_) asked_at_ = clock_();
  read_status();
  const bool stops = status_.board.path_stop != hal::PathStop::none;
  const double reached =
      executed_time() + patience_ * (2.0 * status_.interval + kLatest) + replanning_;
  std::size_t count = under_way();
  std::size_t result = 0;
  for (const Sent* last = &sent(last_id_); count > 0 && last->id != 0; last = &sent(last->before)) {
    if (sent(last->before).id != last->before) return 0;  // it makes no sense: fastest_under_way()
    if (last->tag.spindle_speed != 0.0) return 0;
    const Sent& before = sent(last->before);
    if (before.ordinal == last->ordinal) continue;
    const bool in_time = !stops && has_room() && before.end_time >= reached;
    if (in_time || last->id > cut_.board_end) ++result;
    --count;
  }
  return result;
}

/// One that took longer than usual counts again for the next ones, less each time.
void MotionFeed::commit_cut() {
  constexpr double kMost = 0.1;
  link_.commit_cut();
  if (clock_) replanning_ = std::clamp(clock_() - asked_at_, 0.5 * replanning_, kMost);
}

void MotionFeed::begin_cut(std::size_t count) {
  Id id = last_id_;
  const std::uint64_t kept = sent(id).ordinal - count;
  std::size_t told = 0;
  for (; sent(id).ordinal > kept || id > cut_.board_end; id = sent(id).before) ++told;
  link_.begin_cut(static_cast<std::uint32_t>(id));
  cut_ = {link_.pushed(), id, last_id_, CutAnswer::pending, cut_.board_end};
  go_on_behind(id);
  if (cut_listener_) cut_listener_(told);
  // Of settling the board may have had a part only: the rest begins anew, and has been checked
  // once.
  if (sent(id).end_velocity == Position{}) static_cast<void>(settle());
}

CutAnswer MotionFeed::cut_answer() {
  if (cut_.answer != CutAnswer::pending || status_.items_done < cut_.item) return cut_.answer;
  const bool late = status_.board.cut_late;
  cut_.answer = late ? CutAnswer::late : CutAnswer::taken;
  constexpr double kMostPatience = 16.0;
  patience_ = late ? std::min(2.0 * patience_, kMostPatience) : 1.0;
  if (late) revoke_cut();
  // What was sent with a late cut has higher numbers, and the board dropped it.
  cut_.board_end =
      late ? std::min(cut_.board_end, std::max(id_of(status_.given_before_cut), cut_.kept_id))
           : kAnyId;
  return cut_.answer;
}

/// The board goes on with what it had.
void MotionFeed::revoke_cut() {
  if (cut_listener_) {
    std::size_t told = 0;
    for (Id id = last_id_; id != cut_.kept_id; id = sent(id).before) ++told;
    cut_listener_(told);
    std::vector<const Sent*> again;
    for (Id id = cut_.last_id; id != cut_.kept_id; id = sent(id).before) again.push_back(&sent(id));
    for (auto it = again.rbegin(); listener_ && it != again.rend(); ++it)
      listener_({(*it)->duration, (*it)->end, (*it)->end_velocity, (*it)->feed_limit, (*it)->tag});
  }
  go_on_behind(cut_.last_id);
}

void MotionFeed::go_on_behind(Id id) {
  last_id_ = id;
  commanded_ = sent(id).end;
  check_.restart(commanded_, sent(id).end_velocity);
  motor_check_.restart(sent(id).motors, sent(id).motor_velocity);
  compensation_.restore(sent(id).state);
}

/// Of the segment in execution and of all behind it.
Position MotionFeed::fastest_under_way() const {
  Position fastest;
  const std::uint64_t executing = sent(last_id_).ordinal - under_way();
  // A board may name any segment as the one in execution: not all before it are remembered.
  for (Id id = last_id_; sent(id).id == id; id = sent(id).before) {
    const Sent& segment = sent(id);
    for (const Axis axis : kAllAxes)
      fastest[axis] = std::max({fastest[axis], std::abs(segment.start_velocity[axis]),
                                std::abs(segment.end_velocity[axis])});
    if (id == 0 || segment.ordinal <= executing) break;
  }
  return fastest;
}

double MotionFeed::executed_time() const {
  const Sent& entry = sent(executing_id_);
  if (executing_id_ == 0 || entry.id != executing_id_) return 0.0;
  return entry.end_time - (1.0 - status_.board.executing_phase) * entry.duration;
}

bool MotionFeed::at_rest() const {
  return all_told() && !status_.board.moving && status_.board.fifo_count == 0 &&
         !position_unknown_ && cut_.answer != CutAnswer::pending && cut_.answer != CutAnswer::late;
}

bool MotionFeed::board_goes_on() const {
  return all_told() && executed(last_id_) && cut_.answer != CutAnswer::pending &&
         (status_.board.moving || status_.board.fifo_count > 0);
}

Executing MotionFeed::executing() const {
  const hal::ControllerStatus& board = status_.board;
  const Sent& entry = sent(executing_id_);
  if (executing_id_ == 0 || entry.id != executing_id_ || !board.moving) return {};
  const Position change = entry.end_velocity - entry.start_velocity;
  return {entry.tag, entry.feed_limit, entry.start_velocity + change * board.executing_phase};
}

/// A motor runs on a little behind its pulses, stopped along a ramp or not; switched off then, it
/// has slipped. A segment that waits for the spindle moves nothing yet.
AxisArray<bool> MotionFeed::axes_in_motion() const {
  const hal::ControllerStatus& board = status_.board;
  if (executing_id_ == 0 || sent(executing_id_).id != executing_id_) return {};
  const bool has_begun = board.executing_phase > 0.0;
  const Sent& entry = has_begun ? sent(executing_id_) : sent(sent(executing_id_).before);
  AxisArray<bool> motors;
  const bool in_its_middle = has_begun && board.executing_phase < 1.0;
  if (in_its_middle && entry.id > stopped_id_) motors = entry.moves;
  for (const Axis motor : kAllAxes) motors[motor] |= entry.motor_velocity[motor] != 0.0;
  const double settled = executed_time() + std::max(board.time - moved_at_, 0.0) - kSettling;
  for (Id id = entry.id; id != 0 && sent(id).id == id && sent(id).end_time > settled;
       id = sent(id).before)
    for (const Axis motor : kAllAxes) motors[motor] |= sent(id).moves[motor];
  return axes_of(motors);
}

/// A cut that is not answered may not have reached the board: either path may be under way.
AxisArray<bool> MotionFeed::axes_under_way() const {
  AxisArray<bool> motors;
  add_moves_up_to(last_id_, motors);
  if (cut_.answer == CutAnswer::pending) add_moves_up_to(cut_.last_id, motors);
  AxisArray<bool> axes = axes_of(motors);
  const AxisArray<bool> now = axes_in_motion();
  for (const Axis axis : kAllAxes) axes[axis] = axes[axis] || now[axis];
  return axes;
}

/// Of what the board has not begun, as far as it was heard.
void MotionFeed::add_moves_up_to(Id id, AxisArray<bool>& motors) const {
  const Id reached = std::max(executing_id_, void_id_);
  for (; id > reached && sent(id).id == id; id = sent(id).before)
    for (const Axis motor : kAllAxes) motors[motor] = motors[motor] || sent(id).moves[motor];
}

AxisArray<bool> MotionFeed::axes_of(const AxisArray<bool>& motors) const {
  AxisArray<bool> axes = motors;
  for (const Axis motor : kAllAxes)
    if (motors[motor]) axes[compensation_.kinematics().axis_of(motor)] = true;
  return axes;
}

void MotionFeed::quick_stop() {
  link_.quick_stop();
  std::erase_if(waiting_, [](const LinkItem& item) {
    return !std::holds_alternative<ClearFaults>(item) && !std::holds_alternative<JoinSession>(item);
  });
  cut_ = {};
  position_unknown_ = true;
}

void MotionFeed::accept_board_position() {
  cut_ = {};
  compensation_.restore(state_of_board());
  accept_motors(motors_);
  // What was under way and did not come to its end is over now; the next segment starts at rest.
  Sent& executing = history_[executing_id_ % kHistory];
  const bool is_known = executing.id == executing_id_;
  if (is_known) {
    executing.end_time = executed_time();
    executing.duration = 0.0;
    executing.end_velocity = executing.end_acceleration = executing.motor_velocity = {};
  }
  Sent& last = history_[last_id_ % kHistory];
  if (last.id != executing.id) {
    last.moves = {};
    last.before = is_known ? executing.id : 0;
  }
  last.end_velocity = last.end_acceleration = {};
  last.end_time = executed_time();
  last.ordinal = executing.ordinal;  // nothing is under way
  void_id_ = stopped_id_ = newest_id_;
  position_unknown_ = false;
}

/// The machine stands where its motors are: a plan begins anew from there.
void MotionFeed::accept_motors(const Position& motors) {
  compensation_.accept(motors, slave_tolerance(config_));
  void_state_ = compensation_.state();
  commanded_ = void_state_.machine;
  Sent& last = history_[last_id_ % kHistory];
  last.end = commanded_;
  last.motors = motors;
  last.motor_velocity = {};
  last.state = void_state_;
  check_.restart(commanded_);
  motor_check_.restart(motors);
  if (restart_listener_) restart_listener_(commanded_);
}

void MotionFeed::set_position(Axis axis, double position) {
  Position machine = commanded_;
  machine[axis] = position;
  const Position there = compensation_.motors_at(machine);
  Position motors = compensation_.motors_at(commanded_);
  SetPosition item;
  for (const Axis motor : kAllAxes) {
    if (compensation_.kinematics().axis_of(motor) != axis) continue;
    item.axes[motor] = true;
    item.position[motor] = motors[motor] = there[motor];
  }
  send(item);
  void_id_ = newest_id_;
  accept_motors(motors);
}

Result<void> MotionFeed::use_surface(std::shared_ptr<const motion::HeightSurface> surface) {
  const config::AxisConfig& z = config_.axes[Axis::Z];
  const double there =
      commanded_[Axis::Z] +
      (surface ? surface->at(commanded_[Axis::X], commanded_[Axis::Y]).height : 0.0);
  if (surface && (there < z.negative_limit || there > z.positive_limit))
    return fail(
        ErrorCode::travel_limit,
        fmt::format("The height map takes Z to {:.3f} here; its travel is {:.3f} to {:.3f}.", there,
                    z.negative_limit, z.positive_limit));
  compensation_.use_surface(std::move(surface));
  void_id_ = newest_id_;
  history_[last_id_ % kHistory].state = void_state_ = compensation_.state();
  begin_motion(AxisArray<bool>::filled(true));
  return settle();
}

}  // namespace cnc::server
