#include "api/src/convert.h"

#include <utility>

namespace cnc::api {
namespace {

// The enumerations of the wire have one value more, "unspecified", at 0; otherwise the order is the
// same on both sides.
template <typename Enum, typename WireEnum>
constexpr Enum shifted(WireEnum wire) {
  return static_cast<Enum>(static_cast<int>(wire) - 1);
}
static_assert(shifted<Axis>(v1::AXIS_X) == Axis::X && shifted<Axis>(v1::AXIS_C) == Axis::C);
static_assert(shifted<LatchSource>(v1::LATCH_SOURCE_ESTOP) == LatchSource::estop);
static_assert(shifted<Command>(v1::COMMAND_RESET) == Command::reset &&
              shifted<Command>(v1::COMMAND_STOP) == Command::stop &&
              shifted<Command>(v1::COMMAND_ACCEPT_POSITION) == Command::accept_position &&
              v1::Command_MAX == v1::COMMAND_ACCEPT_POSITION);
static_assert(shifted<Severity>(v1::SEVERITY_INFO) == Severity::info &&
              shifted<Severity>(v1::SEVERITY_ERROR) == Severity::error);
static_assert(shifted<SpindleDirection>(v1::SPINDLE_DIRECTION_OFF) == SpindleDirection::off &&
              shifted<SpindleDirection>(v1::SPINDLE_DIRECTION_COUNTERCLOCKWISE) ==
                  SpindleDirection::counterclockwise);

// MachineState has its own "unknown" at 0, so the numbers are equal.
static_assert(static_cast<int>(MachineState::unknown) == v1::MACHINE_STATE_UNSPECIFIED &&
              static_cast<int>(MachineState::ready) == v1::MACHINE_STATE_READY &&
              static_cast<int>(MachineState::paused) == v1::MACHINE_STATE_PAUSED &&
              static_cast<int>(MachineState::question) == v1::MACHINE_STATE_QUESTION &&
              v1::MachineState_MAX == v1::MACHINE_STATE_QUESTION);

/// The enumerator, or `otherwise` for "unspecified" and for values of a newer API.
template <typename Enum, typename WireEnum>
Enum known_or(WireEnum wire, WireEnum last, Enum otherwise) {
  return wire >= 1 && wire <= last ? shifted<Enum>(wire) : otherwise;
}

AxisValues axis_values(const v1::AxisValues& wire) {
  return {{wire.x(), wire.y(), wire.z(), wire.a(), wire.b(), wire.c()}};
}

template <typename WireAxes>
AxisFlags axis_flags(const WireAxes& wire) {
  AxisFlags flags;
  for (const int value : wire) {
    if (const auto axis = from_wire(static_cast<v1::Axis>(value))) flags[*axis] = true;
  }
  return flags;
}

TextPlace text_place(const v1::TextPlace& wire) {
  return {wire.file(), wire.line(), wire.column()};
}

Problem problem(const v1::Problem& wire) {
  Problem found{.error = from_wire(wire.error(), ErrorKind::invalid),
                .line_text = wire.line_text(),
                .length = wire.length(),
                .warning = wire.warning()};
  for (const v1::CallSite& call : wire.calls())
    found.calls.push_back({call.sub(), text_place(call.place())});
  return found;
}

Question question(const v1::Question& wire) {
  Question asked{.number = wire.number(), .title = wire.title(), .fields = {}};
  for (const v1::QuestionField& field : wire.fields())
    asked.fields.push_back({field.label(), field.parameter(), field.value()});
  return asked;
}

LatchCatch latch_catch(const v1::LatchCatch& wire) {
  return {.source = known_or(wire.source(), v1::LatchSource_MAX, LatchSource::unknown),
          .axis = from_wire(wire.axis()),
          .age = wire.age(),
          .count = wire.count(),
          .position = axis_values(wire.position())};
}

std::vector<LatchCatch> latch_catches(
    const google::protobuf::RepeatedPtrField<v1::LatchCatch>& wire) {
  std::vector<LatchCatch> latches;
  for (const v1::LatchCatch& latch : wire) latches.push_back(latch_catch(latch));
  return latches;
}

JobStatus job_status(const v1::JobStatus& wire) {
  return {.path = wire.path(),
          .lines = wire.lines(),
          .line = wire.line(),
          .progress = wire.progress(),
          .elapsed = wire.elapsed(),
          .prediction_ready = wire.prediction_ready(),
          .predicted_time = wire.predicted_time(),
          .time_left = wire.time_left(),
          .runs = wire.runs(),
          .ended_well = wire.ended_well(),
          .problems = wire.problems(),
          .extents_min = axis_values(wire.extents_min()),
          .extents_max = axis_values(wire.extents_max())};
}

/// A command of which the server says nothing counts as not allowed.
std::array<CommandAvailability, kCommandCount> availabilities(const v1::MachineStatus& wire) {
  std::array<CommandAvailability, kCommandCount> commands;
  commands.fill({.allowed = false, .reason = "The server does not offer this command."});
  for (const v1::CommandAvailability& each : wire.commands()) {
    if (each.command() < 1 || each.command() > v1::Command_MAX) continue;
    commands[static_cast<std::size_t>(shifted<Command>(each.command()))] = {each.allowed(),
                                                                            each.reason()};
  }
  return commands;
}

/// Whatever is not said is not trusted.
AxisArray<PositionTrust> axis_trust(const v1::AxisTrust& wire) {
  const auto trust = [](v1::PositionTrust value) {
    return known_or(value, v1::PositionTrust_MAX, PositionTrust::unknown);
  };
  return {{trust(wire.x()), trust(wire.y()), trust(wire.z()), trust(wire.a()), trust(wire.b()),
           trust(wire.c())}};
}

AxisDescription axis_description(const v1::AxisDescription& wire, Axis axis) {
  return {.axis = axis,
          .negative_limit = wire.negative_limit(),
          .positive_limit = wire.positive_limit(),
          .max_velocity = wire.max_velocity(),
          .max_acceleration = wire.max_acceleration(),
          .max_jerk = wire.max_jerk(),
          .home_position = wire.home_position()};
}

template <typename WireBins>
std::vector<HistogramBin> histogram(const WireBins& wire) {
  std::vector<HistogramBin> bins;
  for (const v1::HistogramBin& bin : wire) bins.push_back({bin.upper(), bin.count()});
  return bins;
}

}  // namespace

v1::Axis to_wire(Axis axis) { return static_cast<v1::Axis>(static_cast<int>(axis) + 1); }

std::optional<Axis> from_wire(v1::Axis axis) {
  if (axis < v1::AXIS_X || axis > v1::AXIS_C) return std::nullopt;
  return shifted<Axis>(axis);
}

Error from_wire(const v1::ErrorDetail& detail, ErrorKind kind) {
  Error error{.kind = kind,
              .code = detail.code(),
              .name = detail.name(),
              .message = detail.message(),
              .check = detail.check(),
              .place = std::nullopt};
  if (detail.has_place()) error.place = text_place(detail.place());
  return error;
}

MachineStatus from_wire(const v1::MachineStatus& wire) {
  MachineStatus status;
  status.sequence = wire.sequence();
  status.time = wire.time();
  status.state = v1::MachineState_IsValid(wire.state()) ? static_cast<MachineState>(wire.state())
                                                        : MachineState::unknown;
  status.state_text = wire.state_text();
  status.machine_position = axis_values(wire.machine_position());
  status.work_position = axis_values(wire.work_position());
  status.homed = axis_flags(wire.homed());
  status.trust = axis_trust(wire.trust());
  status.velocity = axis_values(wire.velocity());
  status.feed = wire.feed();
  status.programmed_feed = wire.programmed_feed();
  status.feed_override = wire.feed_override();
  status.rapid_override = wire.rapid_override();
  status.speed_override = wire.speed_override();
  status.overrides_enabled = wire.overrides_enabled();
  status.spindle = known_or(wire.spindle(), v1::SpindleDirection_MAX, SpindleDirection::off);
  status.spindle_speed = wire.spindle_speed();
  status.mist = wire.mist();
  status.flood = wire.flood();
  status.tool = wire.tool();
  status.selected_tool = wire.selected_tool();
  status.work_system = wire.work_system();
  status.active_codes = wire.active_codes();
  status.job = job_status(wire.job());
  status.commands = availabilities(wire);
  status.estop_input = wire.estop_input();
  status.home_switches = axis_flags(wire.home_switches());
  status.fifo_time = wire.fifo_time();
  status.newest_message = wire.newest_message();
  if (wire.has_question()) status.question = question(wire.question());
  status.probe_input = wire.probe_input();
  return status;
}

ServerVersion from_wire(const v1::GetVersionResponse& wire) {
  return {wire.server_version(), wire.api_major(), wire.api_minor(), wire.controller()};
}

Machine from_wire(const v1::GetMachineResponse& wire) {
  Machine machine{.inch = wire.inch(),
                  .axes = {},
                  .homing_mandatory = wire.homing_mandatory(),
                  .picture_folder = wire.picture_folder()};
  for (const v1::AxisDescription& each : wire.axes()) {
    if (const auto axis = from_wire(each.axis())) {
      machine.axes.push_back(axis_description(each, *axis));
    }
  }
  return machine;
}

LinkStatistics from_wire(const v1::GetLinkStatisticsResponse& wire) {
  return {.real_time = wire.real_time(),
          .cycle_time = wire.cycle_time(),
          .cycles = wire.cycles(),
          .max_lateness = wire.max_lateness(),
          .max_work = wire.max_work(),
          .lateness = histogram(wire.lateness()),
          .work = histogram(wire.work()),
          .lowest_fifo_time = wire.lowest_fifo_time(),
          .fifo_time = histogram(wire.fifo_time()),
          .last_round_trip = wire.last_round_trip(),
          .mean_round_trip = wire.mean_round_trip(),
          .max_round_trip = wire.max_round_trip(),
          .round_trip = histogram(wire.round_trip()),
          .packets = {.sent = wire.packets().sent(),
                      .resent = wire.packets().resent(),
                      .answered = wire.packets().answered(),
                      .passed_over = wire.packets().passed_over(),
                      .corrupted = wire.packets().corrupted()},
          .connected = wire.connected(),
          .sessions = wire.sessions(),
          .board_name = wire.board_name(),
          .board_serial = wire.board_serial(),
          .latches = latch_catches(wire.latches())};
}

ProblemList from_wire(const v1::GetProblemsResponse& wire) {
  ProblemList list{.problems = {}, .complete = wire.complete()};
  for (const v1::Problem& each : wire.problems()) list.problems.push_back(problem(each));
  return list;
}

Message from_wire(const v1::Message& wire) {
  Message message;
  message.sequence = wire.sequence();
  message.time = std::chrono::sys_time<std::chrono::milliseconds>(
      std::chrono::milliseconds(wire.time_unix_ms()));
  message.severity = known_or(wire.severity(), v1::Severity_MAX, Severity::info);
  message.text = wire.text();
  if (wire.has_error()) message.error = from_wire(wire.error(), ErrorKind::failed);
  return message;
}

}  // namespace cnc::api
