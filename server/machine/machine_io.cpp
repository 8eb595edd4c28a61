#include "server/machine/machine_io.h"

#include <algorithm>
#include <fmt/format.h>

namespace cnc::server {

using interp::SpindleDirection;

namespace {

bool changes_speed(const interp::CommandBody& command) {
  const auto* set = std::get_if<interp::SetOverride>(&command);
  return std::holds_alternative<interp::SetSpindleSpeed>(command) ||
         std::holds_alternative<interp::EnableOverrides>(command) ||
         (set != nullptr && set->which == interp::Override::speed);
}

}  // namespace

void MachineIo::enable_drives(bool on) {
  drives_ = on;
  apply();
}

void MachineIo::turn_spindle(SpindleDirection direction) {
  direction_ = direction;
  direction_output_.reset();
  pwm_output_.reset();
  apply();
}

void MachineIo::set_spindle_speed(double rpm) {
  speed_ = rpm;
  apply();
}

void MachineIo::set_speed_override(double factor) {
  override_ = factor;
  apply();
}

void MachineIo::set_coolant(bool mist, bool flood) {
  mist_ = mist;
  flood_ = flood;
  apply();
}

void MachineIo::set_spindle_output(interp::SpindleOutput output, bool on) {
  (output == interp::SpindleOutput::direction ? direction_output_ : pwm_output_) = on;
  apply();
}

Result<void> MachineIo::set_output(std::int32_t port, bool on) {
  const auto bit = hal::port_bit(port);
  if (!bit)
    return fail(ErrorCode::not_on_this_machine, fmt::format("The board has no output {}.", port));
  ports_.set(*bit, on);
  apply();
  return {};
}

Result<void> MachineIo::set_analog_output(std::int32_t port, double value) {
  if (port < 1 || static_cast<std::size_t>(port) > hal::kPwmCount)
    return fail(ErrorCode::not_on_this_machine,
                fmt::format("The board has no PWM output {}.", port));
  pwm_[static_cast<std::size_t>(port - 1)] = value;
  apply();
  return {};
}

Result<double> MachineIo::read(const interp::ReadInput& input) const {
  const hal::Inputs& inputs = feed_.board().inputs;
  const auto no_input = [&](std::string_view kind) {
    return fail(ErrorCode::not_on_this_machine,
                fmt::format("The board has no {} input {}.", kind, input.port));
  };
  if (input.analog) {
    if (input.port < 1 || static_cast<std::size_t>(input.port) > hal::kAnalogCount)
      return no_input("analog");
    return inputs.analog[static_cast<std::size_t>(input.port - 1)];
  }
  constexpr std::int32_t kFirstHome = 51;
  constexpr std::int32_t kFirstSpecial = 61;
  const std::array special{inputs.probe,  inputs.sync,   inputs.hand_wheel_a,  inputs.hand_wheel_b,
                           inputs.estop1, inputs.estop2, inputs.external_error};
  const auto home = static_cast<std::size_t>(input.port - kFirstHome);
  const auto other = static_cast<std::size_t>(input.port - kFirstSpecial);
  if (input.port >= kFirstHome && home < kAxisCount) return inputs.home[kAllAxes[home]] ? 1.0 : 0.0;
  if (input.port >= kFirstSpecial && other < special.size()) return special[other] ? 1.0 : 0.0;
  const auto bit = hal::port_bit(input.port);
  if (!bit) return no_input("digital");
  return inputs.ports.test(*bit) ? 1.0 : 0.0;
}

void MachineIo::all_off() {
  direction_ = SpindleDirection::off;
  direction_output_.reset();
  pwm_output_.reset();
  mist_ = flood_ = false;
  path_switches_ ? send_all() : apply();
}

void MachineIo::board_is_off() {
  direction_ = SpindleDirection::off;
  direction_output_.reset();
  pwm_output_.reset();
  mist_ = flood_ = drives_ = false;
  ports_.reset();
  pwm_ = {};
  outputs_ = {};
  in_doubt_ = {};
  path_switches_ = false;
}

void MachineIo::board_is_back(const hal::Outputs& outputs) {
  drives_ = outputs.drives_enabled;
  outputs_ = {.drives_enabled = drives_};
}

/// What the spindle is told, 0 … 1. S0 leaves it still even after M3 (manual 3.5.2); any other
/// speed is kept within what it can do.
double MachineIo::spindle_part(double speed) const {
  if (speed <= 0.0) return 0.0;
  return std::clamp(speed, spindle_config_.min_speed, spindle_config_.max_speed) /
         spindle_config_.max_speed;
}

void MachineIo::apply_spindle(hal::Outputs& wanted, double speed) const {
  const double part = spindle_part(speed);
  const bool turns = direction_ != SpindleDirection::off && part > 0.0;
  wanted.spindle_on = turns;
  wanted.tool_direction =
      direction_output_.value_or(turns && direction_ == SpindleDirection::clockwise);
  wanted.spindle_pwm = pwm_output_.value_or(turns) ? part : 0.0;
}

hal::Outputs MachineIo::wanted() const {
  hal::Outputs wanted{
      .drives_enabled = drives_, .mist = mist_, .flood = flood_, .ports = ports_, .pwm = pwm_};
  apply_spindle(wanted, speed_ * override_);
  return wanted;
}

void MachineIo::apply() {
  const hal::Outputs wanted = this->wanted();
  const auto change = hal::change_between(outputs_, wanted);
  if (!change) return send_all();
  if (change->empty()) return;
  outputs_ = wanted;
  feed_.send(ChangeOutputs{*change});
  ++sends_;
}

void MachineIo::send_all() {
  outputs_ = wanted();
  feed_.send(SetOutputs{outputs_});
  ++sends_;
  in_doubt_ = {};
  path_switches_ = false;
}

// --- on the way ----------------------------------------------------------------------------------

hal::OutputChange MachineIo::change_for(const interp::CommandBody& command,
                                        const SpindleSpeed& then) const {
  if (const auto* coolant = std::get_if<interp::SetCoolant>(&command))
    return {.mist = coolant->mist, .flood = coolant->flood};
  const bool stands = direction_ == SpindleDirection::off && !pwm_output_;
  if (stands || !then.programmed || !changes_speed(command)) return {};
  hal::Outputs outputs;
  apply_spindle(outputs, *then.programmed * then.factor());
  return {.spindle_on = outputs.spindle_on,
          .tool_direction = outputs.tool_direction,
          .spindle_pwm = outputs.spindle_pwm};
}

std::uint64_t MachineIo::sent_with_path() {
  path_switches_ = true;
  return sends_;
}

/// Whether what was sent meanwhile came before or behind it is not known.
void MachineIo::switched(const hal::OutputChange& change, std::uint64_t ticket) {
  change.apply_to(outputs_);
  if (ticket != sends_) in_doubt_.add(change);
}

void MachineIo::correct() {
  if (in_doubt_.empty()) return;
  if (in_doubt_.spindle_on) in_doubt_.spindle_on = outputs_.spindle_on;
  if (in_doubt_.tool_direction) in_doubt_.tool_direction = outputs_.tool_direction;
  if (in_doubt_.spindle_pwm) in_doubt_.spindle_pwm = outputs_.spindle_pwm;
  if (in_doubt_.mist) in_doubt_.mist = outputs_.mist;
  if (in_doubt_.flood) in_doubt_.flood = outputs_.flood;
  feed_.send(ChangeOutputs{std::exchange(in_doubt_, {})});
  ++sends_;
}

}  // namespace cnc::server
