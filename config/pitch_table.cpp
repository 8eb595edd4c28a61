#include "config/pitch_table.h"

#include <cmath>
#include <fmt/format.h>

#include "config/atomic_file.h"
#include "config/schema.h"
#include "config/text_lines.h"

namespace cnc::config {
namespace {

/// Steeper corrections are a slip of the hand, and would take too much of the axis' acceleration.
constexpr double kSteepest = 0.05;

std::unexpected<Error> refuse(ErrorCode code, std::string message, std::string_view name,
                              std::uint32_t line) {
  return std::unexpected(Error{code, std::move(message), TextPlace{std::string(name), line, 0}});
}

std::string_view without_comment(std::string_view line) {
  return trimmed(line.substr(0, line.find(';')));
}

bool fits_behind(const PitchPoint& before, const PitchPoint& point) {
  const double way = point.machine - before.machine;
  const double truth = point.calibrated - before.calibrated;
  return way > 0.0 && std::abs(truth - way) <= kSteepest * way;
}

std::string example(Axis motor, const MachineConfig& config) {
  const auto text = [&](std::string_view key) {
    const Setting& limit = *find_setting(axis_section(motor), key);
    return setting_text(limit, limit.value(config), config.unit);
  };
  const std::string low = text("negativeLimit");
  const std::string high = text("positiveLimit");
  return fmt::format(
      "; Pitch correction table for axis {}: write what you have measured.\n"
      "; machine position   calibrated position\n"
      "{}   {}\n{}   {}\n",
      axis_name(motor), low, low, high, high);
}

/// The file is in the machine's unit, like cnc.ini.
std::vector<PitchPoint> in_millimetres(std::vector<PitchPoint> points, Axis motor,
                                       MachineUnit unit) {
  constexpr double kMillimetresPerInch = 25.4;
  if (unit == MachineUnit::millimetre || is_rotary(motor)) return points;
  for (PitchPoint& point : points) {
    point.machine *= kMillimetresPerInch;
    point.calibrated *= kMillimetresPerInch;
  }
  return points;
}

}  // namespace

std::string pitch_table_name(Axis motor) {
  return fmt::format("Joint-{}-pitchCompTable.txt", axis_name(motor));
}

Result<std::vector<PitchPoint>> parse_pitch_table(std::string_view text, std::string_view name) {
  const auto lines = split_lines(text, name);
  if (!lines) return std::unexpected(lines.error());
  std::vector<PitchPoint> points;
  for (const TextLine& line : *lines) {
    const auto words = split_words(without_comment(line.text));
    if (words.empty()) continue;
    const auto machine = parse_number(words[0]);
    const auto calibrated = words.size() == 2 ? parse_number(words[1]) : std::nullopt;
    if (!machine || !calibrated)
      return refuse(ErrorCode::pitch_bad_line,
                    fmt::format("Read {}; two numbers are needed: machine position and calibrated "
                                "position.",
                                in_quotes(line.text)),
                    name, line.number);
    const PitchPoint point{*machine, *calibrated};
    if (!points.empty() && !fits_behind(points.back(), point))
      return refuse(ErrorCode::pitch_bad_table,
                    fmt::format("From the line before to this one the machine would go {:.4f} in "
                                "truth for {:.4f}; both must rise, by amounts within {:.0f} %.",
                                point.calibrated - points.back().calibrated,
                                point.machine - points.back().machine, 100.0 * kSteepest),
                    name, line.number);
    points.push_back(point);
  }
  if (points.size() < 2)
    return refuse(ErrorCode::pitch_bad_table, "A pitch table needs at least two lines of numbers.",
                  name, 0);
  return points;
}

Result<void> load_pitch_tables(MachineConfig& config, const std::filesystem::path& folder) {
  for (const Axis motor : kAllAxes) {
    AxisConfig& axis = config.axes[motor];
    axis.pitch_table.clear();
    if (!axis.pitch_compensation || !axis.connected()) continue;
    const auto path = folder / pitch_table_name(motor);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
      if (auto written = write_file_atomically(path, example(motor, config)); !written)
        return written;
    }
    const auto text = read_text_file(path);
    if (!text) return std::unexpected(text.error());
    auto points = parse_pitch_table(*text, path.filename().string());
    if (!points) return std::unexpected(std::move(points.error()));
    axis.pitch_table = in_millimetres(std::move(*points), motor, config.unit);
  }
  return {};
}

}  // namespace cnc::config
