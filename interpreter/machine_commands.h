// Canonical commands of the machine around the motion: outputs and inputs, heads, heaters, guards,
// homing, questions to the operator. canonical.h has the others and puts them together.
//
// Texts and dialogs belong to the interpreter and are valid until its next call; a dialog until it
// has been answered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "config/axis.h"

namespace cnc::interp {

// --- overrides and operator inputs ---------------------------------------------------------------

enum class Override : std::uint8_t { feed, speed };
/// M50 M51: sets an override to `factor` (1 = 100 %), or takes it out of the operator's hand and
/// leaves it as it is.
struct SetOverride {
  Override which = Override::feed;
  std::optional<double> factor;
};
/// M52: the feed override follows the analog input.
struct UseOverrideInput {
  bool on = false;
};
/// M53: the feed hold input acts.
struct UseHoldInput {
  bool on = false;
};

// --- heads and spindle outputs -------------------------------------------------------------------

/// What is at the tool point: M90 M91 M92 (or M93) spindles, M95 probe, M97 camera.
enum class Head : std::uint8_t { spindle_0, spindle_1, spindle_2, probe, camera };
inline constexpr std::size_t kHeadCount = 5;
/// M90 … M97: `offset` of the head from the first spindle, already in the moves that follow.
struct SelectHead {
  Head head = Head::spindle_0;
  Position offset;
};
/// M91 … M97 Q1: the offset of the head has been measured and shall be kept.
struct StoreHeadOffset {
  Head head = Head::spindle_0;
  Position offset;
};
enum class SpindleOutput : std::uint8_t { direction, pwm };
/// M84 M85, M86 M87: one of the spindle's outputs by itself.
struct SetSpindleOutput {
  SpindleOutput output = SpindleOutput::direction;
  bool on = false;
};
/// M80 M81.
struct EnableDrives {
  bool on = false;
};

// --- inputs and outputs --------------------------------------------------------------------------

/// M54 P, M55 P: AUX output 1 …; 100 n + m is output m of I/O card n.
struct SetOutput {
  std::int32_t port = 0;
  bool on = false;
};
/// M54 E Q: PWM output.
struct SetAnalogOutput {
  std::int32_t port = 0;
  double value = 0.0;  ///< 0 … 1
};
enum class WaitForInput : std::uint8_t { no, high, low };
/// M56: the answer goes to #5399. Ports as the manual numbers them: AUX 1 …, 51-56 home switches,
/// 61 probe, 62 sync, 63 64 hand wheel, 65 66 estop, 67 external error, 100 n + m I/O cards.
struct ReadInput {
  std::int32_t port = 0;
  bool analog = false;
  WaitForInput wait = WaitForInput::no;
  double timeout = 0.0;  ///< s, for waiting
};

// --- clamp, torch, heaters -----------------------------------------------------------------------

/// M26 M27: the brake of a rotary axis; while it is on the axis does not move.
struct ClampAxis {
  Axis axis = Axis::A;
  bool on = false;
  std::optional<std::int32_t> port;  ///< AUX output of the brake
};
/// M20 M21: plasma torch height control.
struct UseTorchHeight {
  bool on = false;
};
/// M22 M23 Q: its set point, volts.
struct SetTorchHeight {
  double set_point = 0.0;
};
enum class Heater : std::uint8_t { extruder, bed };
/// M104 M109, M140 M190; `wait`: the program goes on when the temperature is reached.
struct SetTemperature {
  Heater heater = Heater::extruder;
  double celsius = 0.0;
  bool wait = false;
};
/// M143: the extruder is switched off above it.
struct SetTemperatureLimit {
  double celsius = 0.0;
};
/// M106 M107: work piece fan, 0 … 1.
struct SetFan {
  double power = 0.0;
};
/// M1 of a 3D printer.
struct HeatersOff {};
/// M100 P: more (> 1) or fewer steps per unit than configured.
struct ScaleAxis {
  Axis axis = Axis::A;
  double factor = 1.0;
};

// --- language extensions -------------------------------------------------------------------------

/// A value that dlgmsg asks for, or only shows, where the machine alone writes it.
struct DialogField {
  std::string_view label;
  std::int32_t parameter = 0;
  double value = 0.0;  ///< now
};
struct Dialog {
  std::string_view title;  ///< also the name of a picture to show
  std::vector<DialogField> fields;
};
/// dlgmsg: OK or Cancel, and new values. Waits for an Answer.
struct AskOperator {
  const Dialog* dialog = nullptr;
};
/// logfile: where logmsg writes from now on.
struct OpenLogFile {
  std::string_view name;
  bool append = false;
};
/// sp: writes the work position to a file.
struct StorePosition {
  std::string_view name;
  bool append = false;
  Position work_position;
};
enum class Guard : std::uint8_t { machine_area, tool_change_area };
/// MCAGuard, TCAGuard.
struct SetGuard {
  Guard guard = Guard::machine_area;
  bool on = true;
};
/// HomeIsEstop.
struct UseHomeSensorsAsEstop {
  bool on = false;
};
enum class HomeStep : std::uint8_t {
  home,                  ///< home x
  tandem,                ///< HomeTandem x: the three others in order
  prepare_tandem,        ///< PrepareTandemHome x: master and slave onto their switches
  move_slave_to_master,  ///< MoveSlaveToMaster a
};
/// Waits for an Answer.
struct HomeAxis {
  HomeStep step = HomeStep::home;
  Axis axis = Axis::X;
};
enum class KnifeCommand : std::uint8_t {
  off,
  on,
  on_bent_left,   ///< on 90
  on_bent_right,  ///< on -90
  use_b,
  use_c,
  set_low,
  set_high,
};
/// Tanknife …
struct SetKnife {
  KnifeCommand command = KnifeCommand::off;
};
enum class HeightMapCommand : std::uint8_t {
  off,
  on,
  begin,      ///< ZHCINIT
  add_point,  ///< ZHCADDPOINT: where the probe tripped last
  store,      ///< ZHCS
};
/// The ZHC… statements. Adding a point and switching wait for standstill.
struct ChangeHeightMap {
  HeightMapCommand command = HeightMapCommand::off;
  double grid_size = 0.0;  ///< mm, of begin
  std::int32_t columns = 0;
  std::int32_t rows = 0;
  std::string_view name{};  ///< of store
};

/// Nothing but waiting for an Answer: the program reads a value that only the machine knows.
struct Synchronise {};

}  // namespace cnc::interp
