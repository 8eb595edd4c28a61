#include "server/rpc/convert.h"

#include <chrono>
#include <utility>

#include "server/rpc/utf8.h"

namespace cnc::server::rpc {
namespace {

// The public overloads must be seen beside the ones of this file.
using rpc::to_proto;

v1::MachineState to_proto(State state) {
  switch (state) {
    case State::off:
      return v1::MACHINE_STATE_OFF;
    case State::needs_reset:
      return v1::MACHINE_STATE_NEEDS_RESET;
    case State::needs_homing:
      return v1::MACHINE_STATE_NEEDS_HOMING;
    case State::ready:
      return v1::MACHINE_STATE_READY;
    case State::jogging:
      return v1::MACHINE_STATE_JOGGING;
    case State::homing:
      return v1::MACHINE_STATE_HOMING;
    case State::mdi:
      return v1::MACHINE_STATE_MDI;
    case State::running:
      return v1::MACHINE_STATE_RUNNING;
    case State::pausing:
      return v1::MACHINE_STATE_PAUSING;
    case State::paused:
      return v1::MACHINE_STATE_PAUSED;
    case State::program_stop:
      return v1::MACHINE_STATE_PROGRAM_STOP;
    case State::tool_change:
      return v1::MACHINE_STATE_TOOL_CHANGE;
    case State::question:
      return v1::MACHINE_STATE_QUESTION;
    case State::stopping:
      return v1::MACHINE_STATE_STOPPING;
    case State::estop:
      return v1::MACHINE_STATE_ESTOP;
    case State::error:
      return v1::MACHINE_STATE_ERROR;
  }
  return v1::MACHINE_STATE_UNSPECIFIED;
}

v1::Command to_proto(CommandKind command) {
  switch (command) {
    case CommandKind::reset:
      return v1::COMMAND_RESET;
    case CommandKind::home:
      return v1::COMMAND_HOME;
    case CommandKind::jog:
      return v1::COMMAND_JOG;
    case CommandKind::mdi:
      return v1::COMMAND_MDI;
    case CommandKind::load:
      return v1::COMMAND_LOAD;
    case CommandKind::run:
      return v1::COMMAND_RUN;
    case CommandKind::pause:
      return v1::COMMAND_PAUSE;
    case CommandKind::resume:
      return v1::COMMAND_RESUME;
    case CommandKind::stop:
      return v1::COMMAND_STOP;
    case CommandKind::rewind:
      return v1::COMMAND_REWIND;
    case CommandKind::set_override:
      return v1::COMMAND_OVERRIDE;
    case CommandKind::answer:
      return v1::COMMAND_ANSWER;
    case CommandKind::accept_position:
      return v1::COMMAND_ACCEPT_POSITION;
    case CommandKind::set_work_zero:
      return v1::COMMAND_SET_WORK_ZERO;
  }
  return v1::COMMAND_UNSPECIFIED;
}

v1::SpindleDirection to_proto(interp::SpindleDirection direction) {
  switch (direction) {
    case interp::SpindleDirection::off:
      return v1::SPINDLE_DIRECTION_OFF;
    case interp::SpindleDirection::clockwise:
      return v1::SPINDLE_DIRECTION_CLOCKWISE;
    case interp::SpindleDirection::counterclockwise:
      return v1::SPINDLE_DIRECTION_COUNTERCLOCKWISE;
  }
  return v1::SPINDLE_DIRECTION_UNSPECIFIED;
}

v1::Severity to_proto(Severity severity) {
  switch (severity) {
    case Severity::info:
      return v1::SEVERITY_INFO;
    case Severity::warning:
      return v1::SEVERITY_WARNING;
    case Severity::error:
      return v1::SEVERITY_ERROR;
  }
  return v1::SEVERITY_UNSPECIFIED;
}

v1::PositionTrust to_proto(Trust trust) {
  switch (trust) {
    case Trust::trusted:
      return v1::POSITION_TRUST_TRUSTED;
    case Trust::doubtful:
      return v1::POSITION_TRUST_DOUBTFUL;
    case Trust::unknown:
      return v1::POSITION_TRUST_UNKNOWN;
  }
  return v1::POSITION_TRUST_UNSPECIFIED;
}

v1::AxisTrust to_proto(const AxisArray<Trust>& trust) {
  v1::AxisTrust out;
  out.set_x(to_proto(trust[Axis::X]));
  out.set_y(to_proto(trust[Axis::Y]));
  out.set_z(to_proto(trust[Axis::Z]));
  out.set_a(to_proto(trust[Axis::A]));
  out.set_b(to_proto(trust[Axis::B]));
  out.set_c(to_proto(trust[Axis::C]));
  return out;
}

v1::JobStatus to_proto(const JobSnapshot& job) {
  v1::JobStatus out;
  out.set_path(job.path);
  out.set_lines(job.lines);
  out.set_line(job.line);
  out.set_progress(job.progress);
  out.set_elapsed(job.elapsed);
  out.set_prediction_ready(job.prediction_ready);
  out.set_predicted_time(job.predicted_time);
  out.set_time_left(job.time_left);
  out.set_runs(job.runs);
  out.set_ended_well(job.ended_well);
  out.set_problems(job.problems);
  *out.mutable_extents_min() = to_proto(job.extents_min);
  *out.mutable_extents_max() = to_proto(job.extents_max);
  return out;
}

v1::Question to_proto(const QuestionSnapshot& question) {
  v1::Question out;
  out.set_number(question.number);
  out.set_title(valid_utf8(question.title));
  for (const QuestionSnapshot::Field& field : question.fields) {
    v1::QuestionField* row = out.add_fields();
    row->set_label(valid_utf8(field.label));
    row->set_parameter(field.parameter);
    row->set_value(field.value);
  }
  return out;
}

void add_axes(const AxisArray<bool>& flags, google::protobuf::RepeatedField<int>* out) {
  for (const Axis axis : kAllAxes)
    if (flags[axis]) out->Add(to_proto(axis));
}

/// 5xxx is the machine's state; everything else was wrong in what was asked for.
grpc::StatusCode status_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::command_not_allowed:
    case ErrorCode::no_question:
      return grpc::StatusCode::FAILED_PRECONDITION;
    case ErrorCode::file_not_found:
    case ErrorCode::sub_unknown:
      return grpc::StatusCode::NOT_FOUND;
    case ErrorCode::command_interrupted:
      return grpc::StatusCode::ABORTED;
    case ErrorCode::value_out_of_range:
      return grpc::StatusCode::INVALID_ARGUMENT;
    case ErrorCode::internal_error:
      return grpc::StatusCode::INTERNAL;
    default:
      return grpc::StatusCode::ABORTED;
  }
}

}  // namespace

v1::Axis to_proto(Axis axis) { return static_cast<v1::Axis>(index_of(axis) + 1); }

std::optional<Axis> axis_from(v1::Axis axis) {
  if (axis < v1::AXIS_X || axis > v1::AXIS_C) return std::nullopt;
  return static_cast<Axis>(axis - 1);
}

v1::AxisValues to_proto(const Position& position) {
  v1::AxisValues out;
  out.set_x(position[Axis::X]);
  out.set_y(position[Axis::Y]);
  out.set_z(position[Axis::Z]);
  out.set_a(position[Axis::A]);
  out.set_b(position[Axis::B]);
  out.set_c(position[Axis::C]);
  return out;
}

v1::ErrorDetail to_proto(const Error& error) {
  const ErrorInfo& info = error_info(error.code);
  v1::ErrorDetail out;
  out.set_code(static_cast<std::uint32_t>(error.code));
  out.set_name(std::string(info.name));
  out.set_message(error.message);
  out.set_check(std::string(info.check));
  if (error.place) {
    out.mutable_place()->set_file(error.place->file);
    out.mutable_place()->set_line(error.place->line);
    out.mutable_place()->set_column(error.place->column);
  }
  return out;
}

v1::Message to_proto(const LogMessage& message) {
  v1::Message out;
  out.set_sequence(message.sequence);
  out.set_time_unix_ms(
      std::chrono::duration_cast<std::chrono::milliseconds>(message.time.time_since_epoch())
          .count());
  out.set_severity(to_proto(message.severity));
  out.set_text(message.text);
  if (message.error) *out.mutable_error() = to_proto(*message.error);
  return out;
}

v1::MachineStatus to_proto(const MachineSnapshot& snapshot) {
  v1::MachineStatus out;
  out.set_sequence(snapshot.sequence);
  out.set_time(snapshot.time);
  out.set_state(to_proto(snapshot.state));
  out.set_state_text(snapshot.state_text);
  *out.mutable_machine_position() = to_proto(snapshot.machine_position);
  *out.mutable_work_position() = to_proto(snapshot.work_position);
  for (const Axis axis : kAllAxes)
    if (snapshot.trust[axis] == Trust::trusted) out.add_homed(to_proto(axis));
  *out.mutable_trust() = to_proto(snapshot.trust);
  *out.mutable_velocity() = to_proto(snapshot.velocity);
  out.set_feed(snapshot.feed);
  out.set_programmed_feed(snapshot.programmed_feed);
  out.set_feed_override(snapshot.feed_override);
  out.set_rapid_override(snapshot.rapid_override);
  out.set_speed_override(snapshot.speed_override);
  out.set_overrides_enabled(snapshot.overrides_enabled);
  out.set_spindle(to_proto(snapshot.spindle));
  out.set_spindle_speed(snapshot.spindle_speed);
  out.set_mist(snapshot.mist);
  out.set_flood(snapshot.flood);
  out.set_tool(snapshot.tool);
  out.set_selected_tool(snapshot.selected_tool);
  out.set_work_system(snapshot.work_system);
  out.set_active_codes(snapshot.active_codes);
  *out.mutable_job() = to_proto(snapshot.job);
  out.set_estop_input(snapshot.estop_input);
  add_axes(snapshot.home_switches, out.mutable_home_switches());
  out.set_fifo_time(snapshot.fifo_time);
  out.set_newest_message(snapshot.newest_message);
  if (snapshot.question) *out.mutable_question() = to_proto(*snapshot.question);
  out.set_probe_input(snapshot.probe_input);
  for (const CommandRule& rule : command_table()) {
    v1::CommandAvailability* row = out.add_commands();
    row->set_command(to_proto(rule.command));
    const auto reason = refusal(rule.command, snapshot.state);
    row->set_allowed(!reason);
    if (reason) row->set_reason(*reason);
  }
  return out;
}

grpc::Status to_status(const Error& error) {
  return {status_code(error.code), error.to_string(), to_proto(error).SerializeAsString()};
}

grpc::Status to_status(const Result<void>& result) {
  return result ? grpc::Status::OK : to_status(result.error());
}

grpc::Status invalid_argument(std::string message) {
  return to_status(Error{ErrorCode::value_out_of_range, std::move(message), std::nullopt});
}

}  // namespace cnc::server::rpc
