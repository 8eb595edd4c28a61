// Numbers and texts as the operator reads them: always a point as decimal sign, whatever the
// locale, and a true minus sign.
#pragma once

#include <QString>
#include <optional>
#include <string_view>

#include "api/axis.h"

namespace cnc::gui {

[[nodiscard]] QString to_text(std::string_view utf8);

/// "−123.456": three decimals, never "−0.000".
[[nodiscard]] QString position_text(double value);
/// "12.5": as many decimals as it has, up to ten digits, with a plain minus: for editors.
[[nodiscard]] QString value_text(double value);
/// The number that was typed, with a point or a comma; nothing for any other text.
[[nodiscard]] std::optional<double> number_of(const QString& text);
/// "1200": no decimals.
[[nodiscard]] QString whole_text(double value);
/// "120 %" of a factor.
[[nodiscard]] QString percent_text(double factor);
/// "0:07", "12:34", "1:02:03"; an hour has no upper limit.
[[nodiscard]] QString duration_text(double seconds);
/// "1 234 567": groups of three, as counts of lines get long.
[[nodiscard]] QString count_text(qulonglong count);
/// "mm" or "°".
[[nodiscard]] QString unit_text(api::Axis axis);
/// "G54" … "G59", "G59.1" … "G59.3" for work systems 1 … 9.
[[nodiscard]] QString work_system_text(int work_system);
/// The part of a path after the last slash.
[[nodiscard]] QString file_name_text(std::string_view path);

}  // namespace cnc::gui
