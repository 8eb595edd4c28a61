// Actions: what a program wants of the machine while it stands still. Some take time, or a person.
#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <variant>

#include "server/job/job_control.h"
#include "server/job/overloaded.h"
#include "server/job/settings.h"

namespace cnc::server {

JobSignal JobControl::perform(const JobEvent& event) {
  line_ = event.command.source.file == 0 ? event.command.source.line : line_;
  const JobSignal signal = std::visit(
      Overloaded{
          [&](const interp::TurnSpindle& turn) {
            io_.turn_spindle(turn.direction);
            return JobSignal::none;
          },
          [&](const interp::EnableDrives& enable) {
            io_.enable_drives(enable.on);
            return JobSignal::none;
          },
          [&](const interp::ChangeTool& change) {
            io_.turn_spindle(interp::SpindleDirection::off);
            tool_ = change.tool;
            if (config_.job.auto_tool_change) return JobSignal::none;
            log_.add(Severity::info, fmt::format("Change to tool T{}, then resume.", tool_));
            return wait_for(WaitsFor::operator_, JobSignal::tool_change);
          },
          [&](const interp::ProgramStop&) {
            return wait_for(WaitsFor::operator_, JobSignal::program_stop);
          },
          [&](const interp::AskOperator&) {
            return wait_for(WaitsFor::answer, JobSignal::question);
          },
          [&](const interp::HomeAxis&) { return wait_for(WaitsFor::homing, JobSignal::home); },
          [&](const interp::ProbeMove& move) { return start_probe(move); },
          [&](const interp::SyncMove&) {
            wait_began_ = speed_checked_ = feed_.board().time;
            speed_before_ = 0.0;
            return wait_for(WaitsFor::spindle, JobSignal::none);
          },
          [&](const interp::ReadInput&) {
            wait_began_ = feed_.board().time;
            return wait_for(WaitsFor::input, JobSignal::none);
          },
          [&](const interp::ChangeHeightMap& change) {
            return signal_of(change_height_map(change, event.text));
          },
          [&](const interp::SetOutput& set) { return signal_of(io_.set_output(set.port, set.on)); },
          [&](const interp::SetAnalogOutput& set) {
            return signal_of(io_.set_analog_output(set.port, set.value));
          },
          [&](const interp::StoreHeadOffset& store) {
            return signal_of(keep_head_ ? keep_head_(store) : Result<void>{});
          },
          [&](const interp::ClampAxis& clamp) {
            clamped_[clamp.axis] = clamp.on;
            return signal_of(clamp.port ? io_.set_output(*clamp.port, clamp.on) : Result<void>{});
          },
          [&](const interp::SetSpindleOutput& set) {
            io_.set_spindle_output(set.output, set.on);
            return JobSignal::none;
          },
          [&](const interp::ProgramEnd&) {
            if (kind_ == Kind::job) io_.all_off();
            return JobSignal::none;
          },
          [](const auto&) { return JobSignal::none; },
      },
      event.command.body);
  if (active_ && waits_for_ == WaitsFor::nothing) go_on({});
  return signal;
}

JobSignal JobControl::wait_for(WaitsFor what, JobSignal signal) {
  waits_for_ = what;
  return signal;
}

JobSignal JobControl::start_probe(const interp::ProbeMove& move) {
  const auto started = probe_.start(move.end, runner_.feed_of(move));
  return started ? wait_for(WaitsFor::probe, JobSignal::none) : fail_with(started.error());
}

JobSignal JobControl::signal_of(const Result<void>& deed) {
  return deed ? JobSignal::none : fail_with(deed.error());
}

JobSignal JobControl::fail_with(Error error) {
  error_ = std::move(error);
  return finish(JobSignal::failed);
}

/// Before a thread the spindle has to turn at a steady speed, which is measured (manual 3.4.19).
JobSignal JobControl::cycle_spindle() {
  constexpr double kInterval = 0.25;  // s
  constexpr double kSteady = 0.01;    // of the speed, in that time
  constexpr double kTimeout = 10.0;   // s
  const hal::ControllerStatus& board = feed_.board();
  if (board.time - speed_checked_ < kInterval) return JobSignal::none;
  speed_checked_ = board.time;
  const double change =
      std::abs(board.spindle_speed - std::exchange(speed_before_, board.spindle_speed));
  if (board.spindle_speed > 0.0 && change <= kSteady * board.spindle_speed) {
    runner_.set_measured_speed(board.spindle_speed);
    go_on({});
    return JobSignal::none;
  }
  if (board.time - wait_began_ < kTimeout) return JobSignal::none;
  return fail_with({ErrorCode::spindle_not_steady,
                    board.spindle_speed > 0.0
                        ? fmt::format("The spindle does not come to a steady speed ({:.0f} rpm).",
                                      board.spindle_speed)
                        : "The spindle does not turn, or its index sensor gives no pulse.",
                    std::nullopt});
}

/// M56: at once, or when the input is as wanted or the time is over; #5399 is then what it is.
JobSignal JobControl::cycle_input() {
  const auto& input = std::get<interp::ReadInput>(runner_.event().command.body);
  const auto value = io_.read(input);
  if (!value) return fail_with(value.error());
  const bool wanted = input.wait == interp::WaitForInput::no ||
                      (*value != 0.0) == (input.wait == interp::WaitForInput::high);
  if (!wanted && feed_.board().time - wait_began_ < input.timeout) return JobSignal::none;
  interp::Answer answer;
  answer.input = *value;
  go_on(std::move(answer));
  return JobSignal::none;
}

JobSignal JobControl::cycle_probe() {
  probe_.cycle();
  if (probe_.standing()) return JobSignal::standing;
  if (probe_.active()) return JobSignal::none;
  if (const auto& error = probe_.error()) return fail_with(*error);
  if (probe_.tripped()) probe_position_ = probe_.position();
  interp::Answer answer;
  answer.probe_tripped = probe_.tripped();
  answer.probe_position = probe_.position();
  go_on(std::move(answer));
  return JobSignal::none;
}

Result<void> JobControl::change_height_map(const interp::ChangeHeightMap& change,
                                           const std::string& name) {
  using enum interp::HeightMapCommand;
  switch (change.command) {
    case begin:
      if (feed_.surface())
        return fail(ErrorCode::height_map_unusable,
                    "A new height map cannot be measured while one is followed: ZHC OFF first.");
      height_map_ = HeightMap(change.grid_size, change.columns, change.rows);
      return {};
    case add_point:
      return height_map_.add(probe_position_);
    case store:
      return files_.write(name, height_map_.to_text());
    case on: {
      if (!config_.axes[Axis::Z].programmable())
        return fail(ErrorCode::not_on_this_machine, "A height map needs a Z axis.");
      auto surface = height_map_.surface();
      if (!surface) return std::unexpected(std::move(surface.error()));
      return follow(std::move(*surface));
    }
    case off:
      return follow(nullptr);
  }
  return {};
}

/// The planner's limits change with what is left to it.
Result<void> JobControl::follow(std::shared_ptr<const motion::HeightSurface> surface) {
  if (auto used = feed_.use_surface(std::move(surface)); !used) return used;
  planner_ = motion::Planner(job_planner_settings(config_, feed_.limits()), feed_.commanded());
  apply_overrides();
  const motion::HeightSurface* map = feed_.surface();
  runner_.set_height_range(map ? map->lowest() : 0.0, map ? map->highest() : 0.0);
  return {};
}

}  // namespace cnc::server
