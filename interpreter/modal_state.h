// What stays in force from line to line: modes, feed, speed, tool, offsets in force.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "config/plane.h"
#include "interpreter/canonical.h"

namespace cnc::interp {

enum class DistanceMode : std::uint8_t { absolute, incremental };  ///< G90 G91; G90.1 G91.1
/// How far canned cycles retract: G98 to where they began, if that is above R; G99 to R.
enum class RetractMode : std::uint8_t { old_position, r_position };
/// Where the tool length comes from: G49; G43, follows M6; G43 H and G43.1, stay.
enum class LengthSource : std::uint8_t { none, spindle_tool, table, words };

/// G40 G41 G42, as programmed: a negative diameter runs on the other side.
enum class CompensationSide : std::uint8_t { off, left, right };

inline constexpr double kMillimetresPerInch = 25.4;
[[nodiscard]] constexpr double millimetres_per(LengthUnit unit) {
  return unit == LengthUnit::inch ? kMillimetresPerInch : 1.0;
}

/// What S counts under G96, mm/s: metres per minute, or feet per minute.
[[nodiscard]] constexpr double surface_speed_unit(LengthUnit unit) {
  constexpr double kMillimetresPerMetre = 1000.0;
  constexpr double kMillimetresPerFoot = 304.8;
  constexpr double kSecondsPerMinute = 60.0;
  const double way = unit == LengthUnit::inch ? kMillimetresPerFoot : kMillimetresPerMetre;
  return way / kSecondsPerMinute;
}

/// What G17 G18 G19, G20 G21 G70 G71 and G54 … G59.3 select; ten times the G number.
[[nodiscard]] constexpr Plane plane_of(std::int32_t code) {
  return code == 170 ? Plane::xy : code == 180 ? Plane::xz : Plane::yz;
}
[[nodiscard]] constexpr LengthUnit unit_of(std::int32_t code) {
  return code == 200 || code == 700 ? LengthUnit::inch : LengthUnit::millimetre;
}
[[nodiscard]] constexpr std::int32_t work_system_of(std::int32_t code) {
  constexpr std::int32_t kG54 = 540;
  constexpr std::int32_t kG59 = 590;
  return code <= kG59 ? (code - kG54) / 10 + 1 : code - kG59 + 6;
}

struct ModalState {
  std::int32_t motion = 800;  ///< ten times the G number of group 1; G80 = none
  Plane plane = Plane::xy;
  LengthUnit unit = LengthUnit::millimetre;
  DistanceMode distance = DistanceMode::absolute;
  DistanceMode arc_distance = DistanceMode::incremental;
  RetractMode retract = RetractMode::old_position;
  FeedMode feed_mode = FeedMode::per_minute;
  double feed = 0.0;         ///< as last said by SetFeedRate; 0 = not programmed in this mode
  double linear_feed = 0.0;  ///< F of G94 for moves with X Y Z, mm/s; of G95, mm per revolution
  double rotary_feed = 0.0;  ///< F for moves of rotary axes only, degrees instead: never inches
  SetPathMode path;
  CompensationSide compensation = CompensationSide::off;
  LengthSource length_source = LengthSource::none;
  std::int32_t length_tool = 0;  ///< H of G43 H
  std::int32_t work_system = 1;  ///< 1 … 9
  bool g92_active = false;
  bool rotated = false;  ///< G68
  bool scaled = false;   ///< G51
  SpindleDirection spindle = SpindleDirection::off;
  double speed = 0.0;               ///< S of G97, rpm
  bool speed_by_surface = false;    ///< G96
  double surface_speed = 0.0;       ///< S of G96, mm/s
  std::optional<double> max_speed;  ///< D of G96, rpm
  bool mist = false;
  bool flood = false;
  std::int32_t tool = 0;                       ///< in the spindle
  std::int32_t selected_tool = 0;              ///< by T, for the next M6
  bool feed_override_enabled = true;           ///< M48 M49 M50
  bool speed_override_enabled = true;          ///< M48 M49 M51
  Head head = Head::spindle_0;                 ///< M90 … M97
  bool spindle_direction_output = false;       ///< M84
  bool spindle_pwm_output = false;             ///< M86
  bool torch_height = false;                   ///< M20
  bool a_clamped = false;                      ///< M26
  std::optional<std::int32_t> clamp_port;      ///< P of M26
  std::optional<double> extruder_temperature;  ///< degrees Celsius, as programmed last
  std::optional<double> bed_temperature;

  [[nodiscard]] bool overrides_enabled() const {
    return feed_override_enabled && speed_override_enabled;
  }

  /// "G1 G17 G21 G40 G49 G54 G61 G90 G94 G97 M5 M9 M48 T1 F300 S12000": for displays, F and S as
  /// they were written.
  [[nodiscard]] std::string active_codes() const;

  friend bool operator==(const ModalState&, const ModalState&) = default;
};

}  // namespace cnc::interp
