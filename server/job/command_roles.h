// What each canonical command asks of the runner. A command that is listed nowhere does not
// compile.
#pragma once

#include <concepts>
#include <cstdint>
#include <variant>

#include "interpreter/canonical.h"
#include "server/job/overloaded.h"

namespace cnc::server {

enum class Role : std::uint8_t {
  motion,
  dwell,
  feed,
  path_mode,
  guard,
  note,         ///< belongs to an instant of the motion, stops nothing
  action,       ///< needs a standing machine
  unsupported,  ///< this machine cannot do it yet
};

template <class Command, class... Listed>
concept OneOf = (std::same_as<Command, Listed> || ...);

[[nodiscard]] inline Role role_of(const interp::CommandBody& body) {
  using namespace interp;
  return std::visit(
      Overloaded{
          [](const OneOf<RapidMove, FeedMove, ArcMove, SyncMove> auto&) { return Role::motion; },
          [](const Dwell&) { return Role::dwell; },
          [](const SetFeedRate&) { return Role::feed; },
          [](const SetPathMode&) { return Role::path_mode; },
          [](const SetGuard&) { return Role::guard; },
          [](const OneOf<SelectPlane, UseLengthUnit, SetWorkOffset, SetG92Offset, UseToolLength,
                         SelectTool, SelectHead, SetSpindleSpeed, UseSurfaceSpeed, SetCoolant,
                         EnableOverrides, SetOverride, Message, OpenLogFile, StorePosition,
                         UseHomeSensorsAsEstop> auto&) { return Role::note; },
          [](const OneOf<ProbeMove, TurnSpindle, ChangeTool, ProgramStop, ProgramEnd, EnableDrives,
                         SetOutput, SetAnalogOutput, SetSpindleOutput, ReadInput, ClampAxis,
                         StoreHeadOffset, AskOperator, HomeAxis, ChangeHeightMap,
                         Synchronise> auto&) { return Role::action; },
          [](const OneOf<OrientSpindle, UseOverrideInput, UseHoldInput, UseTorchHeight,
                         SetTorchHeight, SetTemperature, SetTemperatureLimit, SetFan, HeatersOff,
                         ScaleAxis, SetKnife> auto&) { return Role::unsupported; },
      },
      body);
}

}  // namespace cnc::server
