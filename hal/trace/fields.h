// The fields of everything that a trace records, each named once: a new field is one line here.
// Who walks through them (field_walkers.h) makes the bytes of a trace of them, the way back, the
// layout that stands in the file, the columns of a table.
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <string_view>
#include <type_traits>

#include "hal/controller.h"
#include "hal/trace/records.h"

namespace cnc::hal::trace {

template <typename S, typename T>
concept Of = std::same_as<std::remove_const_t<S>, T>;

template <typename V, Of<Segment> S>
void visit_fields(V& v, S& s) {
  v("id", s.id);
  v("duration", s.duration);
  v("position", s.position);
  v("velocity", s.velocity);
  v("wait_for_index", s.wait_for_index);
  v("spindle_speed", s.spindle_speed);
  v("change", s.change);
}

template <typename V, Of<OutputChange> S>
void visit_fields(V& v, S& s) {
  v("spindle_on", s.spindle_on);
  v("tool_direction", s.tool_direction);
  v("spindle_pwm", s.spindle_pwm);
  v("mist", s.mist);
  v("flood", s.flood);
  v("port", s.port);
  v("pwm", s.pwm);
}

template <typename V, Of<OutputChange::Port> S>
void visit_fields(V& v, S& s) {
  v("bit", s.bit);
  v("on", s.on);
}

template <typename V, Of<OutputChange::Pwm> S>
void visit_fields(V& v, S& s) {
  v("channel", s.channel);
  v("value", s.value);
}

template <typename V, Of<Outputs> S>
void visit_fields(V& v, S& s) {
  v("drives_enabled", s.drives_enabled);
  v("spindle_on", s.spindle_on);
  v("tool_direction", s.tool_direction);
  v("spindle_pwm", s.spindle_pwm);
  v("mist", s.mist);
  v("flood", s.flood);
  v("ports", s.ports);
  v("pwm", s.pwm);
}

template <typename V, Of<Inputs> S>
void visit_fields(V& v, S& s) {
  v("home", s.home);
  v("probe", s.probe);
  v("sync", s.sync);
  v("hand_wheel_a", s.hand_wheel_a);
  v("hand_wheel_b", s.hand_wheel_b);
  v("estop1", s.estop1);
  v("estop2", s.estop2);
  v("drive_alarm", s.drive_alarm);
  v("external_error", s.external_error);
  v("ports", s.ports);
  v("analog", s.analog);
  v("hand_wheel_count", s.hand_wheel_count);
}

template <typename V, Of<Latch> S>
void visit_fields(V& v, S& s) {
  v("armed", s.armed);
  v("caught", s.caught);
  v("position", s.position);
  v("time", s.time);
}

template <typename V, Of<EventLatch> S>
void visit_fields(V& v, S& s) {
  v("count", s.count);
  v("position", s.position);
  v("time", s.time);
}

template <typename V, Of<ProbeLatch> S>
void visit_fields(V& v, S& s) {
  v("armed", s.armed);
  v("caught", s.caught);
  v("active_at_arming", s.active_at_arming);
  v("position", s.position);
  v("time", s.time);
}

template <typename V, Of<BoardIdentity> S>
void visit_fields(V& v, S& s) {
  v("name", s.name);
  v("serial", s.serial);
}

template <typename V, Of<PacketCounts> S>
void visit_fields(V& v, S& s) {
  v("sent", s.sent);
  v("resent", s.resent);
  v("answered", s.answered);
  v("passed_over", s.passed_over);
  v("corrupted", s.corrupted);
}

template <typename V, Of<ControllerStatus> S>
void visit_fields(V& v, S& s) {
  v("time", s.time);
  v("connected", s.connected);
  v("sessions", s.sessions);
  v("counts_lost", s.counts_lost);
  v("frames_done", s.frames_done);
  v("faults", s.faults);
  v("executing_id", s.executing_id);
  v("executing_phase", s.executing_phase);
  v("fifo_count", s.fifo_count);
  v("fifo_time", s.fifo_time);
  v("path_stop", s.path_stop);
  v("cut_late", s.cut_late);
  v("time_scale", s.time_scale);
  v("moving", s.moving);
  v("position", s.position);
  v("inputs", s.inputs);
  v("spindle_speed", s.spindle_speed);
  v("index_latch", s.index_latch);
  v("home_latch", s.home_latch);
  v("probe_latch", s.probe_latch);
  v("estop_latch", s.estop_latch);
  v("outputs", s.outputs);
  v("guard_counts", s.guard_counts);
  v("board", s.board);
  v("round_trip", s.round_trip);
  v("packets", s.packets);
}

template <typename V, Of<Exchange> S>
void visit_fields(V& v, S& s) {
  v("now", s.now);
  v("frame", s.frame);
  v("machine_state", s.machine_state);
  v("line", s.line);
  v("status", s.status);
}

template <typename V, Of<CutBehind> S>
void visit_fields(V& v, S& s) {
  v("id", s.id);
}

template <typename V, Of<SetOutputs> S>
void visit_fields(V& v, S& s) {
  v("outputs", s.outputs);
}

template <typename V, Of<ChangeOutputs> S>
void visit_fields(V& v, S& s) {
  v("change", s.change);
}

template <typename V, Of<SetPosition> S>
void visit_fields(V& v, S& s) {
  v("axis", s.axis);
  v("position", s.position);
}

template <typename V, Of<ArmHomeLatch> S>
void visit_fields(V& v, S& s) {
  v("axis", s.axis);
  v("edge", s.edge);
}

template <typename V, Of<DisarmHomeLatch> S>
void visit_fields(V& v, S& s) {
  v("axis", s.axis);
}

template <typename V, typename S>
requires std::is_empty_v<S>
void visit_fields(V&, S&) {}

inline constexpr std::array<std::string_view, 24> kOrdinals{
    "1",  "2",  "3",  "4",  "5",  "6",  "7",  "8",  "9",  "10", "11", "12",
    "13", "14", "15", "16", "17", "18", "19", "20", "21", "22", "23", "24"};

template <typename V, typename T, std::size_t N>
requires(N <= kOrdinals.size()) void visit_fields(V& v, std::array<T, N>& values) {
  for (std::size_t i = 0; i < N; ++i) v(kOrdinals.at(i), values[i]);
}
template <typename V, typename T, std::size_t N>
requires(N <= kOrdinals.size()) void visit_fields(V& v, const std::array<T, N>& values) {
  for (std::size_t i = 0; i < N; ++i) v(kOrdinals.at(i), values[i]);
}
template <typename V, typename T>
void visit_fields(V& v, AxisArray<T>& values) {
  for (const Axis axis : kAllAxes) v(axis_name(axis), values[axis]);
}
template <typename V, typename T>
void visit_fields(V& v, const AxisArray<T>& values) {
  for (const Axis axis : kAllAxes) v(axis_name(axis), values[axis]);
}

/// What is unset has a value too, so that all records of a kind are of one size.
template <typename V, typename T>
void visit_fields(V& v, const std::optional<T>& value) {
  const bool is_set = value.has_value();
  const T plain = value.value_or(T{});
  v("is_set", is_set);
  v("value", plain);
}
template <typename V, typename T>
void visit_fields(V& v, std::optional<T>& value) {
  bool is_set = value.has_value();
  T plain = value.value_or(T{});
  v("is_set", is_set);
  v("value", plain);
  value = is_set ? std::optional<T>(plain) : std::nullopt;
}

}  // namespace cnc::hal::trace
