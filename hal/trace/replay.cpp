#include "hal/trace/replay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/ini_file.h"
#include "hal/sim/virtual_controller.h"
#include "hal/trace/card_flicker.h"
#include "hal/trace/replay_beginning.h"
#include "hal/trace/replay_judge.h"
#include "hal/trace/timeline.h"
#include "hal/trace/trace_check.h"

namespace cnc::hal::trace {
namespace {

constexpr double kCycle = kReplayCycle;
/// The board looks at its inputs in each.
constexpr double kSlice =
    double{cpu5::firmware::kSliceTicks} / cpu5::firmware::kTicksPerSecond;  // s
constexpr double kPulse = 2.0 * kSlice;                                     // of an input
constexpr double kClockStart = 1.0;  // s, of the replay: a port's clock begins above 0

/// Without travel: switches are driven as recorded, and nothing stands in the way.
config::MachineConfig without_travel(config::MachineConfig config) {
  for (const Axis axis : kAllAxes) {
    config.axes[axis].negative_limit = config.axes[axis].positive_limit = 0.0;
    config.axes[axis].home_velocity = 0.0;
  }
  return config;
}

void drive_ports(sim::VirtualMachine& machine, const Ports& ports) {
  for (std::size_t port = 0; port < ports.size(); ++port) machine.set_port_input(port, ports[port]);
}

void drive_inputs(sim::VirtualMachine& machine, const Inputs& inputs, std::int32_t& wheel) {
  machine.press_estop(inputs.estop1);
  machine.press_estop2(inputs.estop2);
  machine.raise_external_error(inputs.external_error);
  machine.stick_probe(inputs.probe);
  for (const Axis axis : kAllAxes) {
    machine.stick_switch(axis, sim::VirtualMotor::Switch::home, inputs.home[axis]);
    machine.raise_drive_alarm(axis, inputs.drive_alarm[axis]);
  }
  drive_ports(machine, inputs.ports);
  for (std::size_t i = 0; i < kAnalogCount; ++i) machine.set_analog_input(i, inputs.analog[i]);
  const std::int64_t turned = std::int64_t{inputs.hand_wheel_count} - wheel;  // may have gone round
  wheel = inputs.hand_wheel_count;
  machine.turn_hand_wheel(static_cast<std::int32_t>(turned));
}

struct Ask {
  Controller& board;

  void operator()(const Segment& segment) const { board.push({&segment, 1}); }
  void operator()(const CutBehind& cut) const { board.cut_behind(cut.id); }
  void operator()(const SetOutputs& set) const { board.set_outputs(set.outputs); }
  void operator()(const ChangeOutputs& set) const { board.change_outputs(set.change); }
  void operator()(const QuickStop&) const { board.quick_stop(); }
  void operator()(const StopAlongPath&) const { board.stop_along_path(); }
  void operator()(const ReleaseStop&) const { board.release_stop(); }
  void operator()(const ClearFaults&) const { board.clear_faults(); }
  void operator()(const SetPosition& set) const { board.set_position(set.axis, set.position); }
  void operator()(const ArmHomeLatch& arm) const { board.arm_home_latch(arm.axis, arm.edge); }
  void operator()(const DisarmHomeLatch& latch) const { board.disarm_home_latch(latch.axis); }
  void operator()(const ArmProbeLatch&) const { board.arm_probe_latch(); }
  void operator()(const DisarmProbeLatch&) const { board.disarm_probe_latch(); }
};

class Player {
 public:
  Player(const Trace& trace, std::span<const Event> events, const config::MachineConfig& config,
         const Beginning& beginning)
      : trace_(trace),
        events_(events),
        config_(config),
        beginning_(beginning),
        compared_(events[beginning.event].step),
        compared_at_(events[beginning.event].time),
        executed_before_(trace.steps[compared_].exchange.status.executing_id),
        controller_(
            sim::make_virtual_controller(without_travel(config), {.driver = trace.about.driver})) {}

  [[nodiscard]] Result<std::vector<Seen>> play() {
    auto taken = beginning_.path.empty() ? take_over_at_rest() : take_over_in_motion();
    if (!taken) return std::unexpected(taken.error());
    for (const Event& event : events_.subspan(beginning_.event + 1)) perform(event);
    return std::move(seen_);
  }

 private:
  [[nodiscard]] double begin_time() const { return events_[beginning_.event].time; }
  [[nodiscard]] const ControllerStatus& recorded() const {
    return trace_.steps[events_[beginning_.event].step].exchange.status;
  }
  /// On the port's clock, which never goes back.
  const ControllerStatus& exchange(double time) {
    clock_ = std::max(clock_, time);
    return controller_->exchange(controller_time());
  }
  [[nodiscard]] double controller_time() const { return clock_ - origin_ + kClockStart; }

  /// A moment before, with inputs, outputs and positions as they were. Rules of I/O cards that are
  /// true then act at the connection and are over; an estop comes last, because the board keeps
  /// outputs that are on only through a fault.
  [[nodiscard]] Result<void> set_scene(double time, const Position& position) {
    origin_ = clock_ = time - 6.0 * kCycle;
    Inputs inputs = recorded().inputs;
    inputs.estop1 = inputs.estop2 = false;
    drive_inputs(controller_->machine(), inputs, wheel_);
    pass_time(origin_);
    pass_time(origin_ + kCycle);  // the board has seen them when its rules come
    if (auto connected = controller_->connect(); !connected)
      return std::unexpected(connected.error());
    exchange(origin_ + kCycle);
    exchange(origin_ + 2.0 * kCycle);
    controller_->clear_faults();
    controller_->set_outputs(recorded().outputs);
    for (const Axis axis : kAllAxes) controller_->set_position(axis, position[axis]);
    exchange(origin_ + 3.0 * kCycle);
    drive_inputs(controller_->machine(), recorded().inputs, wheel_);
    guards_.begin(exchange(origin_ + 4.0 * kCycle));
    return {};
  }

  [[nodiscard]] Result<void> take_over_at_rest() {
    if (auto set = set_scene(begin_time(), recorded().position); !set) return set;
    compare_from_ = begin_time();
    exchange(begin_time());
    return {};
  }

  /// From a standstill with even acceleration, so that the end of the segment in execution is
  /// reached in time and at its speed.
  [[nodiscard]] Result<void> take_over_in_motion() {
    const Segment& first = beginning_.path.front();
    const double time = beginning_.run_up;
    const double end = begin_time() + beginning_.rest;
    const Position start = first.position - first.velocity * (0.5 * time);
    if (auto set = set_scene(end - time, start); !set) return set;
    exchange(end - time - kCycle);
    const std::uint32_t pieces = beginning_.pieces;
    for (std::uint32_t piece = 1; piece <= pieces; ++piece) {
      const double part = static_cast<double>(piece) / pieces;
      Ask{*controller_}(Segment{.id = first.id - pieces + piece,
                                .duration = time / pieces,
                                .position = start + first.velocity * (0.5 * time * part * part),
                                .velocity = first.velocity * part});
    }
    for (const Segment& segment : std::span(beginning_.path).subspan(1)) Ask{*controller_}(segment);
    for (double at = end - time; at < begin_time(); at += kCycle) exchange(at);
    compare_from_ = end + kCycle;
    return {};
  }

  void perform(const Event& event) {
    const Step& step = trace_.steps[event.step];
    switch (event.kind) {
      case Event::Kind::inputs:
        pass_time(event.time);
        return drive_inputs(controller_->machine(), step.exchange.status.inputs, wheel_);
      case Event::Kind::pulse:
        return give_pulse(event.time);
      case Event::Kind::card_pulse:
        return give_card_pulses(event);
      case Event::Kind::reset:
        pass_time(event.time);
        executed_before_ = 0;
        return controller_->board().reset();
      case Event::Kind::cable_in:
        controller_->trouble().cable_out = false;
        return;
      case Event::Kind::cable_out:
        controller_->trouble().cable_out = true;
        return;
      case Event::Kind::requests:
        for (const Request& request : step.requests) std::visit(Ask{*controller_}, request);
        exchange(event.time);
        return;
      case Event::Kind::silence:
        exchange(event.time);
        return;
      case Event::Kind::compare:
        return see(event, exchange(event.time));
    }
  }
  /// The board's alone: no packet that would tell it that its host is there.
  void pass_time(double time) {
    clock_ = std::max(clock_, time);
    controller_->board().advance_to(controller_time());
  }

  /// Too short for a status to show it, long enough for the board.
  void give_pulse(double time) {
    pass_time(time);
    controller_->machine().press_estop(true);
    pass_time(time + kPulse);
    controller_->machine().press_estop(false);
  }

  /// Too short for a status to show them, too: they are over before the next.
  void give_card_pulses(const Event& event) {
    const ControllerStatus& before = trace_.steps[compared_].exchange.status;
    const ControllerStatus& after = trace_.steps[event.step].exchange.status;
    const std::vector<Ports> moments = flickers(before, after, config_.guards);
    if (moments.empty()) return;
    pass_time(event.time);
    const double end = compared_at_ + (after.time - before.time);
    const double room = (end - clock_) / (2.0 * static_cast<double>(moments.size()));
    const double width = std::max(std::min(kPulse, room), kSlice);
    for (const Ports& ports : moments) {
      if (clock_ + width >= end) return;
      drive_ports(controller_->machine(), ports);
      pass_time(clock_ + width);
      drive_ports(controller_->machine(), after.inputs.ports);
      pass_time(clock_ + width);
    }
  }

  void see(const Event& event, const ControllerStatus& status) {
    compared_ = event.step;
    compared_at_ = event.time;
    if (event.time < compare_from_) return;
    const std::uint32_t executing = status.executing_id;
    seen_.push_back({.step = event.step,
                     .faults = status.faults,
                     .executing_id = executing != 0 ? executing : executed_before_,
                     .path_stop = status.path_stop,
                     .cut_late = status.cut_late,
                     .moving = status.moving,
                     .position = status.position,
                     .outputs = status.outputs,
                     .home_latch = status.home_latch,
                     .probe_latch = status.probe_latch,
                     .guard_counts = guards_.since_beginning(status)});
  }

  const Trace& trace_;
  std::span<const Event> events_;
  const config::MachineConfig& config_;
  const Beginning& beginning_;
  std::size_t compared_;  // the last step that was, or the one to begin with
  double compared_at_;
  std::uint32_t executed_before_;  // by the recorded board; the last until this one executes any
  std::unique_ptr<sim::VirtualController> controller_;
  std::int32_t wheel_ = 0;
  double origin_ = 0.0;
  double clock_ = 0.0;
  double compare_from_ = 0.0;
  GuardTally guards_;
  std::vector<Seen> seen_;
};

}  // namespace

Result<ReplayReport> replay(const Trace& trace) {
  const auto config =
      config::parse_machine_config(trace.about.config, "configuration of the trace");
  if (!config) return std::unexpected(config.error().front());
  if (const auto absurd = what_no_board_says(trace))
    return fail(ErrorCode::trace_cannot_begin, *absurd + " No board does that.");
  const std::vector<Event> events = timeline_of(trace);
  const auto beginning = find_beginning(trace, events, *config);
  if (!beginning)
    return fail(ErrorCode::trace_cannot_begin,
                "Nowhere in the trace does the board stand still, or is all of its FIFO known.");
  auto seen = Player(trace, events, *config, *beginning).play();
  if (!seen) return std::unexpected(seen.error());
  ReplayReport report;
  report.begin = events[beginning->event].step;
  report.in_motion = !beginning->path.empty();
  judge(trace, *seen, *config, report);
  return report;
}

}  // namespace cnc::hal::trace
