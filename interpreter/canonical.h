// Canonical commands: what a program means once offsets, units, modes and expressions are resolved.
//
// They are the only thing that leaves the interpreter for the machine. Each kind is a small value
// of its own; positions are machine coordinates in mm and degrees with every offset applied (work
// offset, G92, rotation, scaling, tool length), feeds are mm/s, times are seconds, so nothing
// downstream can see inches, minutes or a work coordinate system. Names and order follow the
// canonical machining functions of the NIST RS274/NGC interpreter (Kramer, Proctor, Messina,
// NISTIR 6556, section 4); text_of() prints them in that form.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "config/axis.h"
#include "config/plane.h"
#include "interpreter/machine_commands.h"

namespace cnc::interp {

/// The source line that a command comes from: index of the file (0 is the job) and line from 1.
struct SourceLine {
  std::uint16_t file = 0;
  std::uint32_t line = 0;

  friend constexpr bool operator==(SourceLine, SourceLine) = default;
};

enum class LengthUnit : std::uint8_t { millimetre, inch };                        ///< G21 G20
enum class FeedMode : std::uint8_t { per_minute, inverse_time, per_revolution };  ///< G94 G93 G95
enum class PathMode : std::uint8_t { exact_path, exact_stop, continuous };        ///< G61 G61.1 G64
enum class SpindleDirection : std::uint8_t { off, clockwise, counterclockwise };  ///< M5 M3 M4

// --- motion: each of these moves the machine to `end`, from wherever it is ---------------------

/// G0: straight, every axis at most at its rapid velocity.
struct RapidMove {
  Position end;
};

/// G1: straight at the feed rate.
struct FeedMove {
  Position end;
};

/// G2 G3: arc or helix in `plane` around (first_centre, second_centre), turning along the third
/// axis and the rotary axes meanwhile. First and second axis of the plane are X Y for xy, Z X for
/// xz, Y Z for yz. `turns` counts as in ARC_FEED: positive counter-clockwise, negative clockwise,
/// 1 for less than or exactly one full turn, 2 for one more full turn …
struct ArcMove {
  Position end;
  double first_centre = 0.0;
  double second_centre = 0.0;
  std::int32_t turns = 1;
  Plane plane = Plane::xy;
};

/// G38.2: straight at the feed rate towards `end` until the probe trips. Waits for an Answer.
struct ProbeMove {
  Position end;
};

/// G33 G33.1 G74 G76 G84: straight, `pitch` mm of way per turn of the spindle, begun at its index
/// pulse, so that the next pass meets the thread of the one before. One that follows another
/// directly belongs to the same thread: it goes on without waiting for the pulse.
struct SyncMove {
  Position end;
  double pitch = 0.0;
};

/// G4: stand still for `duration` seconds; 0 waits until every move before it is done.
struct Dwell {
  double duration = 0.0;
};

// --- modal settings for the moves that follow ----------------------------------------------------

/// F in the active feed mode: mm/s (or deg/s for rotary-only moves); moves per second for inverse
/// time; mm per revolution for G95.
struct SetFeedRate {
  FeedMode mode = FeedMode::per_minute;
  double feed = 0.0;
};

/// G61 Q R, G61.1, G64 P Q R; lengths in mm, angle in degrees; unset where the word is missing.
struct SetPathMode {
  PathMode mode = PathMode::exact_path;
  std::optional<double> tolerance;       ///< P
  std::optional<double> simplification;  ///< Q
  std::optional<double> laf_angle;       ///< R

  friend bool operator==(const SetPathMode&, const SetPathMode&) = default;
};

struct SelectPlane {
  Plane plane = Plane::xy;
};
struct UseLengthUnit {
  LengthUnit unit = LengthUnit::millimetre;
};

/// G10 L2/L20, G54…G59.3: work offsets as they now are; `system` 1…9 is the active one when
/// `is_active`. For the displays: moves are already in machine coordinates.
struct SetWorkOffset {
  std::int32_t system = 1;
  bool is_active = true;
  Position offset;
};
/// G92 family: the offset now in force. For the displays.
struct SetG92Offset {
  Position offset;
};
/// G43 G49: the tool length now in force, along Z and X, mm. For the displays.
struct UseToolLength {
  double z = 0.0;
  double x = 0.0;
};

// --- machine functions
// -----------------------------------------------------------------------------

struct SetSpindleSpeed {
  double speed = 0.0;  ///< rpm
};
/// G96: the spindle's speed follows the distance of the tool from the turning axis (work X = 0).
/// SetSpindleSpeed ends it.
struct UseSurfaceSpeed {
  double surface_speed = 0.0;       ///< mm/s at the tool
  std::optional<double> max_speed;  ///< D, rpm
};
/// G87: stop the spindle where its tool fits through the hole, `angle` degrees behind the index.
struct OrientSpindle {
  double angle = 0.0;
};
struct TurnSpindle {
  SpindleDirection direction = SpindleDirection::off;
};
/// M7 M8 M9: which coolants are on from now.
struct SetCoolant {
  bool mist = false;
  bool flood = false;
};
/// T: the tool that the next M6 will bring.
struct SelectTool {
  std::int32_t tool = 0;
};
/// M6: stop, have the operator or the changer bring `tool`. Waits for an Answer.
struct ChangeTool {
  std::int32_t tool = 0;
};
/// M48 M49: whether the operator's overrides act.
struct EnableOverrides {
  bool feed = true;
  bool speed = true;
};

// --- flow
// ------------------------------------------------------------------------------------------

enum class StopKind : std::uint8_t { program_stop, optional_stop, pallet_stop };  ///< M0; M1; M60
/// Wait for the operator's "go on". M1 waits only when the optional stop switch is on. He may have
/// moved the machine meanwhile, so the program waits for an Answer.
struct ProgramStop {
  StopKind kind = StopKind::program_stop;
};
/// M2 M30, or the end of the file. The last command of a program.
struct ProgramEnd {};

enum class MessageKind : std::uint8_t {
  message,  ///< msg, (MSG,...)
  warning,  ///< warnmsg; a ProgramStop follows
  error,    ///< errmsg; the program fails after it
  log,      ///< logmsg
  comment,  ///< (...) and ;...
};
/// Text for the operator. `text` belongs to the interpreter and is valid until its next call.
struct Message {
  MessageKind kind = MessageKind::message;
  std::string_view text;
};

using CommandBody =
    std::variant<RapidMove, FeedMove, ArcMove, ProbeMove, SyncMove, Dwell, SetFeedRate, SetPathMode,
                 SelectPlane, UseLengthUnit, SetWorkOffset, SetG92Offset, UseToolLength,
                 SetSpindleSpeed, UseSurfaceSpeed, OrientSpindle, TurnSpindle, SetCoolant,
                 SelectTool, ChangeTool, EnableOverrides, ProgramStop, ProgramEnd, Message,
                 SetOverride, UseOverrideInput, UseHoldInput, SelectHead, StoreHeadOffset,
                 EnableDrives, SetOutput, SetAnalogOutput, ReadInput, SetSpindleOutput, ClampAxis,
                 UseTorchHeight, SetTorchHeight, SetTemperature, SetTemperatureLimit, SetFan,
                 HeatersOff, ScaleAxis, AskOperator, OpenLogFile, StorePosition, SetGuard,
                 UseHomeSensorsAsEstop, HomeAxis, SetKnife, ChangeHeightMap, Synchronise>;

/// Where a move leads; nothing for a command that is no move.
[[nodiscard]] inline const Position* end_of(const CommandBody& body) {
  return std::visit(
      []<typename Body>(const Body& command) -> const Position* {
        if constexpr (requires { Position{command.end}; }) return &command.end;
        return nullptr;
      },
      body);
}

struct Command {
  CommandBody body;
  SourceLine source;
};

/// Whether the program cannot go on before the world has answered (answer.h).
template <typename Body>
inline constexpr bool kWaitsForAnswer =
    std::is_same_v<Body, ProbeMove> || std::is_same_v<Body, ChangeTool> ||
    std::is_same_v<Body, ProgramStop> || std::is_same_v<Body, ReadInput> ||
    std::is_same_v<Body, AskOperator> || std::is_same_v<Body, HomeAxis> ||
    std::is_same_v<Body, Synchronise>;
[[nodiscard]] bool waits_for_answer(const CommandBody& body);

/// The command in NIST names and argument order, six decimals, mm, machine coordinates, without a
/// line end: "STRAIGHT_FEED(1.000000, 2.000000, …)". docs/canonical.md lists them all.
[[nodiscard]] std::string text_of(const Command& command);
/// The same behind `text`, for those who print millions of them.
void append_text(std::string& text, const Command& command);

}  // namespace cnc::interp
