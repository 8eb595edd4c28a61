// The machine's cycle: what happens by itself, every few milliseconds.
#include <fmt/format.h>
#include <utility>

#include "server/machine/machine.h"

namespace cnc::server {
namespace {

constexpr double kResetTimeout = 2.0;  // s for a board to clear faults and switch its drives on

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
  feed_.hand_over();
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
  std::string warning = fmt::format("The job would stop with an error ({} found), first: {}",
                                    findings_->problem_count(), first.to_string());
  // Looked at again, behind each run and reset, it is no news.
  if (warning == told_finding_) return;
  log_.add(Severity::warning, warning);
  told_finding_ = std::move(warning);
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
      if (!feed_.at_rest()) quick_stop();
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
  trust_.take(TrustEvent::homing_begun, only(axis));
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
  analyse();
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
    trust_.homed(*axis);
    log_.add(Severity::info, fmt::format("Axis {} is homed.", axis_name(*axis)));
  }
  if (homing_.active()) return;
  if (job_.active()) return end_homing_for_job();
  interpreter_.set_position(feed_.commanded());
  analyse();
  come_to_rest();
  if (const auto& error = homing_.error()) {
    log_.add(*error);
    io_.send_all();  // what was on its way may have gone with a quick stop
    settle(WaitFor::home, std::unexpected(*error));
  } else {
    settle(WaitFor::home, {});
  }
}

void Machine::end_homing_for_job() {
  if (const auto& error = homing_.error()) {
    log_.add(*error);
    io_.send_all();
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
    quick_stop();
  }
  if (jog_.active() || state_ == State::stopping) return;
  interpreter_.set_position(feed_.commanded());
  come_to_rest();
}

/// Reset: stand still, clear the board's faults, switch the drives on.
void Machine::cycle_reset() {
  const bool is_at_work = job_.active() || homing_.active() || jog_.active();
  if (!reset_wanted_ || is_at_work) return;
  const hal::ControllerStatus& board = feed_.board();
  if (reset_deadline_ == 0.0) reset_deadline_ = now_ + kResetTimeout;
  // Clearing faults makes the board forget outputs that are on their way: it has to have them all.
  if (!reset_is_sent_ && feed_.at_rest()) {
    reset_is_sent_ = true;
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
  if (reset_is_sent_ && board.faults == 0 && board.outputs.drives_enabled && feed_.at_rest()) {
    reset_wanted_ = false;
    feed_.accept_board_position();
    interpreter_.set_position(feed_.commanded());
    interpreter_.reset();
    come_to_rest();
    load_macros();
    analyse();
    if (has_sub("user_reset")) return run_text("gosub user_reset", "user_reset");
    settle(WaitFor::reset, {});
    return;
  }
  if (reset_is_sent_ && board.faults == 0) io_.enable_drives(true);
  if (now_ < reset_deadline_) return;
  reset_wanted_ = false;
  const std::string_view undone =
      reset_is_sent_ ? "The board did not clear its faults and switch its drives on in time."
                     : "The board did not come to rest and do what it had been told in time.";
  settle(WaitFor::reset,
         board.inputs.estop()
             ? fail(ErrorCode::estop_pressed,
                    "The emergency stop is still pressed: release it, then reset again.")
             : fail(ErrorCode::controller_not_answering, std::string(undone)));
}

}  // namespace cnc::server
