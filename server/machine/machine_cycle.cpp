// The machine's cycle: what happens by itself, every few milliseconds.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "server/machine/machine.h"

namespace cnc::server {
namespace {

constexpr double kResetTimeout = 2.0;  // s for a board to clear faults and switch its drives on

struct FaultText {
  hal::Fault fault;
  ErrorCode code;
  std::string_view text;
};

constexpr std::array kFaultTexts{
    FaultText{hal::Fault::estop, ErrorCode::estop_pressed, "Emergency stop is pressed."},
    FaultText{hal::Fault::fifo_underrun, ErrorCode::motion_fault,
              "The board ran out of motion segments while moving (FIFO underrun)."},
    FaultText{hal::Fault::bad_segment, ErrorCode::motion_fault,
              "The board refused a motion segment."},
    FaultText{hal::Fault::step_loss, ErrorCode::motion_fault,
              "A drive raised its alarm: its motor has lost steps, or the drive is in a fault."},
    FaultText{hal::Fault::link_lost, ErrorCode::motion_fault, "The board lost the connection."},
    FaultText{hal::Fault::index_missing, ErrorCode::motion_fault,
              "The spindle's index pulse did not come: the spindle must turn, and its sensor be "
              "connected to the Sync input."},
};

std::unexpected<Error> stopped_by_operator() {
  return fail(ErrorCode::command_interrupted, "Stopped by the operator.");
}

}  // namespace

void Machine::cycle(double now) {
  last_cycle_ = std::exchange(now_, now);
  feed_.update();
  watch_board();
  cycle_job();
  cycle_homing();
  cycle_jog();
  cycle_stop();
  cycle_reset();
  take_findings();
  answer_saved();
  snapshots_.publish(take_snapshot());
}

void Machine::take_findings() {
  if (findings_ || !analysis_) return;
  findings_ = analysis_->findings();
  if (!findings_ || findings_->problem_count() == 0) return;
  const Error first = findings_->report.errors.empty() ? *findings_->prediction.error
                                                       : findings_->report.errors[0].to_error();
  log_.add(Severity::warning, fmt::format("The job would stop with an error ({} found), first: {}",
                                          findings_->problem_count(), first.to_string()));
}

void Machine::watch_board() {
  const hal::ControllerStatus& board = feed_.board();
  if (!board.connected) {
    if (state_ != State::off) on_fault(static_cast<hal::Faults>(hal::Fault::link_lost));
    enter(State::off);
    if (std::exchange(reset_wanted_, false))
      settle(WaitFor::reset, fail(ErrorCode::controller_not_answering,
                                  "The connection to the board was lost during the reset."));
    return;
  }
  if (state_ == State::off) {
    feed_.accept_board_position();
    interpreter_.set_position(feed_.commanded());
    enter(State::needs_reset);
  }
  watch_home_switches();
  if (board.faults != 0 && state_ != State::estop && state_ != State::error) on_fault(board.faults);
  // The board may still have been braking its last steps when the fault was seen.
  if ((state_ == State::estop || state_ == State::error) && !board.moving)
    feed_.accept_board_position();
}

/// STA-4: behind homing, a home switch that becomes active is an emergency stop where that is
/// wanted. Pulses stop at once; the machine may be jogged off the switch after a reset.
void Machine::watch_home_switches() {
  const AxisArray<bool> before = std::exchange(home_switches_, feed_.board().inputs.home);
  if (!job_.home_is_estop() || homing_.active()) return;
  for (const Axis axis : kAllAxes) {
    if (!home_switches_[axis] || before[axis] || !homed_[axis]) continue;
    stop_at_once({ErrorCode::home_switch_active,
                  fmt::format("The home switch of {} became active.", axis_name(axis)),
                  std::nullopt});
    return;
  }
}

void Machine::on_fault(hal::Faults faults) {
  const auto row = std::ranges::find_if(kFaultTexts, [&](const FaultText& text) {
    return (faults & static_cast<hal::Faults>(text.fault)) != 0;
  });
  const bool known = row != kFaultTexts.end();
  lose_position_of_moving_axes();
  io_.board_is_off();
  feed_.accept_board_position();
  end_everything({known ? row->code : ErrorCode::motion_fault,
                  known ? std::string(row->text)
                        : fmt::format("The board reports a fault that is not known ({}).", faults),
                  std::nullopt});
}

void Machine::stop_at_once(Error error) {
  lose_position_of_moving_axes();
  feed_.quick_stop();
  io_.all_off();
  end_everything(std::move(error));
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

/// An axis that is stopped without a ramp may have lost steps: it has to be homed again.
void Machine::lose_position_of_moving_axes() {
  const AxisArray<bool> moving = feed_.axes_in_motion();
  for (const Axis axis : kAllAxes)
    if (moving[axis] && std::exchange(homed_[axis], false))
      log_.add(
          Severity::warning,
          fmt::format("Axis {} was stopped without a ramp: its position may be wrong. Home it.",
                      axis_name(axis)));
}

void Machine::cycle_job() {
  job_.follow_surface_speed();
  if (!job_.active()) return;
  const bool advances = state_ == State::running || state_ == State::pausing;
  if (advances) elapsed_ += now_ - last_cycle_;
  const JobSignal signal = job_.cycle();
  if (!single_line_) {
    if (const std::uint64_t move = feed_.executing().tag.id; move > move_) {
      move_ = move;
      move_began_ = elapsed_;
    }
    line_ = job_.line();
  }
  on_job_signal(signal);
}

void Machine::on_job_signal(JobSignal signal) {
  switch (signal) {
    case JobSignal::none:
      break;
    case JobSignal::standing:
      if (state_ == State::stopping) {
        end_job(stopped_by_operator());
      } else if (state_ == State::pausing) {
        enter(State::paused);
        settle(WaitFor::pause, {});
      }
      break;
    case JobSignal::program_stop:
      wait_for_operator(State::program_stop);
      break;
    case JobSignal::tool_change:
      wait_for_operator(State::tool_change);
      break;
    case JobSignal::question:
      ++question_;
      wait_for_operator(State::question);
      break;
    case JobSignal::home:
      home_for_job();
      break;
    case JobSignal::ended:
      end_job({});
      break;
    case JobSignal::failed: {
      const Error error = job_.error();
      log_.add(error);
      // A setpoint that was refused leaves the machine in motion without an end.
      if (!feed_.at_rest()) {
        lose_position_of_moving_axes();
        feed_.quick_stop();
      }
      end_job(std::unexpected(error));
      break;
    }
  }
}

void Machine::wait_for_operator(State state) {
  if (state_ == State::stopping) return end_job(stopped_by_operator());
  waiting_state_ = state;
  enter(state);
  settle(WaitFor::pause, {});
}

void Machine::home_for_job() {
  if (state_ == State::stopping) return end_job(stopped_by_operator());
  const auto [step, axis] = job_.home_request();
  const auto refuse = [&](Error error) {
    log_.add(error);
    end_job(std::unexpected(std::move(error)));
  };
  if (step != interp::HomeStep::home) {
    return refuse({ErrorCode::not_on_this_machine,
                   fmt::format("{} is homed with \"home\"; a slave follows it.", axis_name(axis)),
                   std::nullopt});
  }
  if (!data_.config.axes[axis].programmable()) {
    return refuse({ErrorCode::axis_not_connected,
                   fmt::format("Axis {} is not connected; it cannot be homed.", axis_name(axis)),
                   std::nullopt});
  }
  homed_[axis] = false;
  homing_.start({axis});
  enter(State::homing);
}

/// The job or single line is over, well or not.
void Machine::end_job(const Result<void>& result) {
  job_.abandon();
  const bool was_job = !std::exchange(single_line_, false);
  if (was_job || !result) interpreter_.cancel_cutter_compensation();
  // A wrong line of the operator moves nothing and switches nothing.
  const bool interrupted = !result && result.error().code == ErrorCode::command_interrupted;
  if (interrupted || (was_job && !result)) io_.all_off();
  if (was_job) {
    ++runs_;
    ended_well_ = result.has_value();
    if (result) log_.add(Severity::info, fmt::format("Job done in {:.1f} s.", elapsed_));
  }
  save_parameters();
  if (!was_job) analyse();
  settle_when_saved(WaitFor::mdi, result);
  settle(WaitFor::home, result);
  if (!reset_wanted_) settle(WaitFor::reset, result);  // user_reset
  settle(WaitFor::pause, fail(ErrorCode::command_interrupted, "The job ended before the pause."));
  come_to_rest();
}

void Machine::come_to_rest() {
  // After a quick stop the position is known only when the board stands: cycle_stop() comes back.
  if (feed_.stopping()) return enter(State::stopping);
  enter(resting_state());
  settle(WaitFor::rest, {});
}

void Machine::cycle_stop() {
  if (state_ == State::stopping && job_.waits_for_operator() && !jog_.active())
    end_job(fail(ErrorCode::command_interrupted, "The job was stopped."));
  if (state_ == State::stopping && !job_.active() && !feed_.stopping()) {
    interpreter_.set_position(feed_.commanded());
    come_to_rest();
  }
  if (is_motionless() && shutting_down_) io_.all_off();
}

void Machine::cycle_homing() {
  if (!homing_.active()) return;
  if (const auto axis = homing_.cycle()) {
    homed_[*axis] = true;
    log_.add(Severity::info, fmt::format("Axis {} is homed.", axis_name(*axis)));
  }
  if (homing_.active()) return;
  if (job_.active()) return end_homing_for_job();
  interpreter_.set_position(feed_.commanded());
  analyse();
  come_to_rest();
  if (const auto& error = homing_.error()) {
    log_.add(*error);
    settle(WaitFor::home, std::unexpected(*error));
  } else {
    settle(WaitFor::home, {});
  }
}

void Machine::end_homing_for_job() {
  if (const auto& error = homing_.error()) {
    log_.add(*error);
    return end_job(std::unexpected(*error));
  }
  job_.home_done();
  enter(working_state());
}

void Machine::cycle_jog() {
  if (!jog_.active()) return;
  jog_.cycle(now_);
  if (const auto& error = jog_.error()) {
    log_.add(*error);
    lose_position_of_moving_axes();
    feed_.quick_stop();
  }
  if (jog_.active() || state_ == State::stopping) return;
  interpreter_.set_position(feed_.commanded());
  come_to_rest();
}

/// Reset: stand still, clear the board's faults, switch the drives on.
void Machine::cycle_reset() {
  if (!reset_wanted_ || !is_motionless()) return;
  const hal::ControllerStatus& board = feed_.board();
  if (reset_deadline_ == 0.0) {
    // Clearing faults makes the board forget outputs that are on their way: it has to have them
    // all.
    if (!feed_.at_rest()) return;
    reset_deadline_ = now_ + kResetTimeout;
    if (board.inputs.estop()) reset_deadline_ = now_;  // no point in waiting for a hand
    feed_.send(ClearFaults{});
    // A board in fault has everything off and may have dropped what it was told since.
    if (board.faults != 0)
      io_.board_is_off();
    else
      io_.all_off();
    return;
  }
  if (board.faults == 0 && board.outputs.drives_enabled && feed_.at_rest()) {
    reset_wanted_ = false;
    feed_.accept_board_position();
    interpreter_.set_position(feed_.commanded());
    interpreter_.reset();
    come_to_rest();
    load_macros();
    if (has_sub("user_reset")) return run_text("gosub user_reset", "user_reset");
    settle(WaitFor::reset, {});
    return;
  }
  if (board.faults == 0) io_.enable_drives(true);
  if (now_ < reset_deadline_) return;
  reset_wanted_ = false;
  settle(WaitFor::reset,
         board.inputs.estop()
             ? fail(ErrorCode::estop_pressed,
                    "The emergency stop is still pressed: release it, then reset again.")
             : fail(ErrorCode::controller_not_answering,
                    "The board did not clear its faults and switch its drives on in time."));
}

}  // namespace cnc::server
