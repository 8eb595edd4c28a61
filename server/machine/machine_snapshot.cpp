// What the machine shows of itself.
#include <algorithm>
#include <cmath>

#include "server/machine/machine.h"

namespace cnc::server {

MachineSnapshot Machine::take_snapshot() {
  const hal::ControllerStatus& board = feed_.board();
  const Executing executing = feed_.executing();
  const ShownOffsets offsets = job_.offsets();
  const Overrides& overrides = job_.overrides();

  MachineSnapshot shown;
  shown.sequence = ++sequence_;
  shown.time = now_;
  shown.state = state_;
  shown.state_text =
      state_ == State::needs_homing ? trust_.advice() : std::string(state_info(state_).waits);
  shown.machine_position = board.position;
  // Rotation and scaling (G68, G51) are shown as the interpreter has them, which is up to a
  // look-ahead early; offsets as they are executed.
  const interp::ModalState& modal = interpreter_.modal();
  shown.work_position = modal.rotated || modal.scaled ? interpreter_.to_work(board.position)
                                                      : board.position - offsets.total();
  if (data_.config.interpreter.diameter_programming && !modal.rotated && !modal.scaled)
    shown.work_position[Axis::X] *= 2.0;  // to_work() has it already
  shown.trust = trust_.all();
  shown.velocity = executing.velocity;
  const double linear = linear_length(executing.velocity);
  shown.feed = linear > 0.0 ? linear : rotary_length(executing.velocity);
  shown.programmed_feed = executing.feed_limit;
  shown.feed_override = overrides.feed;
  shown.rapid_override = overrides.rapid;
  shown.speed_override = overrides.speed;
  shown.overrides_enabled = job_.overrides_enabled();
  shown.spindle = io_.spindle();
  shown.spindle_speed = io_.spindle_speed();
  shown.mist = io_.outputs().mist;
  shown.flood = io_.outputs().flood;
  shown.tool = job_.tool();
  shown.selected_tool = job_.selected_tool();
  shown.work_system = offsets.system;
  shown.active_codes = modal.active_codes();
  shown.job = take_job_snapshot();
  shown.question = take_question_snapshot();
  shown.estop_input = board.inputs.estop();
  shown.probe_input = board.inputs.probe;
  shown.home_switches = board.inputs.home;
  shown.fifo_time = board.fifo_time;
  shown.board_connected = board.connected;
  shown.board = board.board;
  shown.board_sessions = board.sessions;
  shown.latches = {.board_time = board.time,
                   .home = board.home_latch,
                   .probe = board.probe_latch,
                   .spindle_index = board.index_latch,
                   .estop = board.estop_latch};
  shown.newest_message = log_.newest();
  return shown;
}

std::optional<QuestionSnapshot> Machine::take_question_snapshot() const {
  const interp::Dialog* dialog = job_.question();
  if (dialog == nullptr) return std::nullopt;
  QuestionSnapshot question{question_, std::string(dialog->title), {}};
  for (const interp::DialogField& field : dialog->fields)
    question.fields.push_back({std::string(field.label), field.parameter, field.value});
  return question;
}

JobSnapshot Machine::take_job_snapshot() {
  JobSnapshot shown;
  if (!program_) return shown;
  shown.path = program_path_;
  shown.lines = program_->line_count();
  shown.line = line_;
  shown.elapsed = elapsed_;
  shown.runs = runs_;
  shown.ended_well = ended_well_;
  const bool runs_now = job_.active() && !single_line_;
  const bool over = runs_ > 0 && !runs_now && line_ != 0;
  if (over && ended_well_) shown.progress = 1.0;
  if (!findings_) {
    if (!over && shown.lines > 0)
      shown.progress = static_cast<double>(line_) / static_cast<double>(shown.lines);
    return shown;
  }
  shown.prediction_ready = true;
  shown.problems = findings_->problem_count();
  shown.extents_min = findings_->report.motion.lowest;
  shown.extents_max = findings_->report.motion.highest;
  shown.predicted_time = findings_->prediction.time();
  if (over || shown.predicted_time <= 0.0) return shown;
  const double rate = job_.overrides_enabled() ? job_.overrides().feed : 1.0;
  const double done = predicted_time_done(rate);
  shown.progress = std::clamp(done / shown.predicted_time, 0.0, 1.0);
  if (rate > 0.0) shown.time_left = (shown.predicted_time - done) / rate;
  return shown;
}

/// How far the job is on the time line of its prediction: all moves before the one in execution,
/// and as much of that one as the time since it began.
double Machine::predicted_time_done(double rate) const {
  if (line_ == 0) return 0.0;
  const Prediction& prediction = findings_->prediction;
  const double before = move_ == 0 ? 0.0 : prediction.time_at(move_ - 1);
  return std::min(prediction.time_at(move_), before + (elapsed_ - move_began_) * rate);
}

}  // namespace cnc::server
