// What the board does by itself: it comes and goes, stops in a fault, and its home switches may be
// an emergency stop. What that ends, and what it leaves of the trust in the axes' positions.
#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "hal/fault_names.h"
#include "server/machine/machine.h"

namespace cnc::server {
namespace {

struct FaultText {
  hal::Fault fault;
  ErrorCode code;
  std::string_view text;
};

Error error_of_guard(std::size_t number, const config::GuardRule& rule) {
  return {ErrorCode::guard_stop,
          fmt::format("I/O card {}, rule {}: {}", number / config::kRulesPerCard + 1,
                      number % config::kRulesPerCard + 1,
                      rule.text.empty() ? "its inputs are as the rule says." : rule.text),
          std::nullopt};
}

constexpr std::array kFaultTexts{
    FaultText{hal::Fault::estop, ErrorCode::estop_pressed, "Emergency stop is pressed."},
    FaultText{hal::Fault::fifo_underrun, ErrorCode::motion_fault,
              "The board ran out of motion segments while moving (FIFO underrun)."},
    FaultText{hal::Fault::bad_segment, ErrorCode::motion_fault,
              "The board refused a motion segment."},
    FaultText{hal::Fault::step_loss, ErrorCode::motion_fault,
              "A drive raised its alarm: its motor has lost steps, or the drive is in a fault."},
    FaultText{hal::Fault::guard_stop, ErrorCode::guard_stop,
              "A guard rule of an I/O card has stopped the machine at once."},
    FaultText{hal::Fault::link_lost, ErrorCode::link_lost,
              "The board heard nothing from the server and stopped by itself."},
    FaultText{hal::Fault::index_missing, ErrorCode::motion_fault,
              "The spindle's index pulse did not come: the spindle must turn, and its sensor be "
              "connected to the Sync input."},
};

}  // namespace

void Machine::watch_board() {
  const hal::ControllerStatus& board = feed_.board();
  const bool is_new_session = board.sessions != session_;
  if (state_ != State::off && (!board.connected || is_new_session)) lose_board();
  if (const auto obstacle = obstacle_watch_.look(board.obstacle, now_)) log_.add(*obstacle);
  if (!board.connected) return;
  if (state_ == State::off) take_board();
  watch_home_switches();
  watch_guards();
  watch_path_stop();
  watch_standstill();
  const auto begun = static_cast<hal::Faults>(board.faults & ~std::exchange(faults_, board.faults));
  const bool has_ended = state_ == State::estop || state_ == State::error;
  if (board.faults != 0 && !has_ended) on_fault(board.faults);
  if (begun != 0 && has_ended) on_further_fault(begun);
  watch_drives(board.outputs.drives_enabled);
  // The board may still have been braking its last steps when the fault was seen.
  if ((state_ == State::estop || state_ == State::error) && !board.moving)
    feed_.accept_board_position();
}

/// Nothing goes on by itself after a loss: the operator resets and decides. Drives may still be on.
void Machine::take_board() {
  const hal::ControllerStatus& board = feed_.board();
  const bool is_back = session_ != 0;
  // A session that was over before it was seen may have been the first after a reset.
  const bool counts_lost = board.counts_lost || (is_back && board.sessions - session_ > 1);
  session_ = board.sessions;
  guard_counts_ = {};
  guard_stop_.reset();
  faults_ = board.faults;
  was_sane_at_ = now_;
  io_.board_is_back(board.outputs);
  feed_.join_session();
  feed_.accept_board_position();
  interpreter_.set_position(feed_.commanded());
  home_switches_ = board.inputs.home;
  if (is_back) log_.add(Severity::info, "The controller board is connected again.");
  if (counts_lost && is_back) tell_fault("board_reset");
  if (counts_lost) lose_trust(TrustEvent::counts_lost, AxisArray<bool>::filled(true));
  enter(is_back && board.faults == 0 ? State::error : State::needs_reset);
}

/// What had been sent may have been executed while nothing was heard.
void Machine::lose_board() {
  tell_fault("link_lost");
  lose_trust(TrustEvent::link_lost, feed_.axes_under_way());
  watch_drives(false);  // a board that hears nothing switches them off
  io_.board_is_off();
  feed_.accept_board_position();
  const Error lost{ErrorCode::link_lost,
                   "The connection to the controller board was lost. The server goes on trying to "
                   "make it again.",
                   std::nullopt};
  end_everything(lost);
  if (std::exchange(reset_wanted_, false)) settle(WaitFor::reset, std::unexpected(lost));
  enter(State::off);
  if (loss_listener_ && !shutting_down_) loss_listener_();
}

/// CFG-16: the board has acted already; here it is told. A rule that has been true while nothing
/// was going on stops nothing either.
void Machine::watch_guards() {
  const hal::ControllerStatus& board = feed_.board();
  for (std::size_t i = 0; i < config::kGuardRules; ++i) {
    const std::uint8_t before = std::exchange(guard_counts_[i], board.guard_counts[i]);
    const auto times = static_cast<std::uint8_t>(board.guard_counts[i] - before);
    const config::GuardRule& rule = data_.config.guards[i];
    if (const auto told = guard_messages_[i].due(times, now_))
      log_.add(Severity::warning, error_of_guard(i, rule).message +
                                      (*told > 1 ? fmt::format(" ({} times)", *told) : ""));
    if (times != 0 && rule.action == config::GuardAction::smooth_stop)
      guard_stop_ = error_of_guard(i, rule);
  }
  if (guard_stop_) obey_guard();
}

/// A motor without current can be turned, a vertical axis sags, and a stepper goes to where it is
/// drawn when it is switched on again: an axis that is homed by hand meanwhile, too. Drives with an
/// encoder know (drivesHoldPosition).
void Machine::watch_drives(bool on) {
  if (!on && !data_.config.safety.drives_hold_position)
    lose_trust(TrustEvent::drives_off, AxisArray<bool>::filled(true));
}

/// Until the board stands the path that it brakes along is still fed.
void Machine::obey_guard() {
  const hal::ControllerStatus& board = feed_.board();
  if (board.faults != 0) return guard_stop_.reset();  // that has stopped everything
  if (board.path_stop == hal::PathStop::stopping || board.moving) return;
  Error error = std::move(*guard_stop_);
  guard_stop_.reset();
  feed_.accept_board_position();
  feed_.send(ReleaseStop{});
  io_.all_off();
  if (!job_.active() && !homing_.active() && !jog_.active()) return;
  tell_fault("guard_stop");
  end_everything(std::move(error));
}

/// A rule may act once more before its stop is released, a probe touch behind its move: nobody
/// waits for that stop, and what was sent since is void.
void Machine::watch_path_stop() {
  const hal::ControllerStatus& board = feed_.board();
  if (board.path_stop != hal::PathStop::stopped || board.moving || board.faults != 0) return;
  if (guard_stop_ || job_.probing() || !feed_.all_told()) return;
  feed_.accept_board_position();
  feed_.send(ReleaseStop{});
  if (!job_.active() && !homing_.active() && !jog_.active()) return;
  tell_fault("path_stop");
  io_.all_off();
  end_everything(
      {ErrorCode::motion_fault,
       "The board stopped along the path: the probe, or an input of a guard rule, became "
       "active when nothing waited for it.",
       std::nullopt});
}

/// A board that stands and takes nothing, or moves behind the end of all that it was given: none
/// that makes sense does so for long, and whatever waits for it would wait for ever.
void Machine::watch_standstill() {
  constexpr double kPatience = 3.0;  // s
  const hal::ControllerStatus& board = feed_.board();
  const bool has_ended = state_ == State::estop || state_ == State::error;
  const bool takes_nothing = !feed_.all_told() && !board.moving && board.fifo_count == 0;
  if (has_ended || !(takes_nothing || feed_.board_goes_on())) was_sane_at_ = now_;
  if (now_ - was_sane_at_ < kPatience) return;
  tell_fault("standstill");
  stop_at_once({ErrorCode::motion_fault,
                takes_nothing
                    ? "The board stands, and takes nothing of what it is given."
                    : "The board says that it moves, although it has executed all that it was "
                      "given.",
                std::nullopt});
}

/// STA-4: behind homing, a home switch that becomes active is an emergency stop where that is
/// wanted. Pulses stop at once; the machine may be jogged off the switch after a reset.
void Machine::watch_home_switches() {
  const AxisArray<bool> before = std::exchange(home_switches_, feed_.board().inputs.home);
  if (!job_.home_is_estop() || homing_.active()) return;
  for (const Axis axis : kAllAxes) {
    if (!home_switches_[axis] || before[axis] || trust_[axis] != Trust::trusted) continue;
    stop_at_once({ErrorCode::home_switch_active,
                  fmt::format("The home switch of {} became active.", axis_name(axis)),
                  std::nullopt});
    return;
  }
}

void Machine::on_fault(hal::Faults faults) {
  tell_fault(hal::fault_names(faults));
  const auto row = std::ranges::find_if(kFaultTexts, [&](const FaultText& text) {
    return (faults & static_cast<hal::Faults>(text.fault)) != 0;
  });
  const bool known = row != kFaultTexts.end();
  lose_trust(TrustEvent::stopped_on_the_spot, feed_.axes_in_motion());
  if ((faults & static_cast<hal::Faults>(hal::Fault::step_loss)) != 0)
    lose_trust(TrustEvent::steps_lost, feed_.axes_of(feed_.board().inputs.drive_alarm));
  io_.board_is_off();
  feed_.accept_board_position();
  end_everything({known ? row->code : ErrorCode::motion_fault,
                  known ? std::string(row->text)
                        : fmt::format("The board reports a fault that is not known ({}).", faults),
                  std::nullopt});
}

void Machine::tell_fault(std::string_view name) const {
  if (fault_listener_) fault_listener_(name);
}

/// Everything has ended before. It may cost trust all the same, and decides what a reset waits for.
void Machine::on_further_fault(hal::Faults faults) {
  lose_trust(TrustEvent::stopped_on_the_spot, feed_.axes_in_motion());
  if ((faults & static_cast<hal::Faults>(hal::Fault::step_loss)) != 0)
    lose_trust(TrustEvent::steps_lost, feed_.axes_of(feed_.board().inputs.drive_alarm));
  io_.board_is_off();
  if ((faults & static_cast<hal::Faults>(hal::Fault::estop)) == 0 || state_ == State::estop) return;
  log_.add(Error{ErrorCode::estop_pressed, "Emergency stop is pressed.", std::nullopt});
  enter(State::estop);
}

void Machine::stop_at_once(Error error) {
  quick_stop();
  io_.all_off();
  end_everything(std::move(error));
}

/// It reaches the board a little later than what is known of it now.
void Machine::quick_stop() {
  lose_trust(TrustEvent::stopped_on_the_spot, feed_.axes_under_way());
  feed_.quick_stop();
  io_.send_all();
}

/// Whatever was going on is over, without a ramp.
void Machine::end_everything(Error error) {
  log_.add(error);
  jog_.drop();
  homing_.drop();
  const bool had_job = job_.active();
  job_.abandon();
  enter(error.code == ErrorCode::estop_pressed ? State::estop : State::error);
  const auto interrupted = fail(ErrorCode::command_interrupted, error.message);
  if (had_job && !single_line_) ended_well_ = false;
  for (const WaitFor what : {WaitFor::home, WaitFor::mdi, WaitFor::pause})
    settle(what, interrupted);
  if (!reset_wanted_) settle(WaitFor::reset, interrupted);  // user_reset
  settle(WaitFor::rest, {});
}

void Machine::lose_trust(TrustEvent event, const AxisArray<bool>& axes) {
  if (trust_.take(event, axes) == AxisArray<bool>{}) return;
  log_.add(Severity::warning, fmt::format("{} {}", sentence_of(event), trust_.advice()));
}

}  // namespace cnc::server
