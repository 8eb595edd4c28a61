#include "hal/sim/scenario_player.h"

#include <algorithm>

#include "hal/sim/virtual_machine.h"

namespace cnc::hal::sim {
namespace {

using cpu5::firmware::Ticks;

/// Does each action to the stage.
struct Performer {
  Stage& stage;

  void operator()(const CableMoves& cable) const { stage.trouble.cable_out = cable.out; }
  void operator()(const LinkChanges& link) const {
    LinkTrouble& trouble = stage.trouble;
    trouble.loss = link.loss.value_or(trouble.loss);
    trouble.duplication = link.duplication.value_or(trouble.duplication);
    trouble.corruption = link.corruption.value_or(trouble.corruption);
    trouble.delay = link.delay.value_or(trouble.delay);
    trouble.jitter = link.jitter.value_or(trouble.jitter);
  }
  void operator()(const BoardRestarts&) const { stage.reset_board = true; }
  void operator()(const SwitchSticks& s) const {
    stage.machine.stick_switch(s.axis, s.which, s.state);
  }
  void operator()(const ProbeSticks& probe) const { stage.machine.stick_probe(probe.state); }
  void operator()(const DoorContactSticks& door) const { stage.machine.stick_door(door.state); }
  void operator()(const EstopButton& button) const {
    if (button.channel1) stage.machine.press_estop(button.pressed);
    if (button.channel2) stage.machine.press_estop2(button.pressed);
  }
  void operator()(const ExternalError& error) const {
    stage.machine.raise_external_error(error.raised);
  }
  void operator()(const StepsAreLost& lost) const {
    stage.machine.lose_steps(lost.axis, lost.steps);
  }
  void operator()(const DriveAlarm& alarm) const {
    stage.machine.raise_drive_alarm(alarm.axis, alarm.raised);
  }
  void operator()(const IndexSensor& index) const {
    stage.machine.set_index_missing(index.missing);
  }
  void operator()(const DoorMoves& door) const { stage.machine.open_door(door.open); }
  void operator()(const AnalogChanges& analog) const {
    stage.machine.set_analog_input(analog.input, analog.part);
  }
  void operator()(const PortChanges& port) const {
    stage.machine.set_port_input(port.port, port.active);
  }
  void operator()(const HandWheelTurns& wheel) const {
    stage.machine.turn_hand_wheel(wheel.counts);
  }
  void operator()(const ToolIsLoaded& tool) const { stage.machine.load_tool(tool.number); }
};

void perform(const ScenarioAction& action, Stage& stage) { std::visit(Performer{stage}, action); }

}  // namespace

ScenarioPlayer::ScenarioPlayer(std::vector<ScenarioEvent> events) {
  for (ScenarioEvent& event : events) {
    if (const Ticks* time = std::get_if<Ticks>(&event.when)) {
      timed_.push_back({*time, event.action});
    } else {
      placed_.push_back({std::get<PlacePassed>(event.when), event.action, false, false});
    }
  }
  std::ranges::stable_sort(timed_, {}, &Timed::time);
  placed_left_ = placed_.size();
  if (placed_.empty()) next_ = timed_.empty() ? kNever : timed_.front().time;
}

void ScenarioPlayer::advance(Ticks now, Stage& stage) {
  for (; timed_done_ < timed_.size() && timed_[timed_done_].time <= now; ++timed_done_) {
    perform(timed_[timed_done_].action, stage);
  }
  for (Placed& event : placed_) {
    if (!event.done) look(event, stage);
  }
  const Ticks next_timed = timed_done_ < timed_.size() ? timed_[timed_done_].time : kNever;
  const Ticks next_look = placed_left_ > 0 ? (now / kLookInterval + 1) * kLookInterval : kNever;
  next_ = std::min(next_timed, next_look);
}

void ScenarioPlayer::look(Placed& event, Stage& stage) {
  const double position = stage.machine.physical_position(event.place.axis);
  const bool beyond =
      event.place.upwards ? position > event.place.place : position < event.place.place;
  if (beyond && event.came_from_before) {
    event.done = true;
    --placed_left_;
    perform(event.action, stage);
  }
  event.came_from_before = !beyond;
}

}  // namespace cnc::hal::sim
