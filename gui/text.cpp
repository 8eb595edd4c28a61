#include "gui/text.h"

#include <algorithm>
#include <cmath>

namespace cnc::gui {
namespace {

constexpr QChar kMinus{0x2212};
constexpr QChar kThinSpace{0x2009};

QString fixed_text(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  const double rounded = std::round(value * scale) / scale;
  const QString digits = QString::number(std::abs(rounded), 'f', decimals);
  return rounded < 0.0 ? kMinus + digits : digits;
}

QString two_digits(qint64 value) { return QString::number(value).rightJustified(2, u'0'); }

}  // namespace

QString to_text(std::string_view utf8) {
  return QString::fromUtf8(utf8.data(), static_cast<qsizetype>(utf8.size()));
}

QString position_text(double value) { return fixed_text(value, 3); }

QString value_text(double value) { return QString::number(value, 'g', 10); }

std::optional<double> number_of(const QString& text) {
  QString plain = text.trimmed();
  plain.replace(u',', u'.').replace(kMinus, u'-');
  bool is_number = false;
  const double value = plain.toDouble(&is_number);  // in every locale with a point
  if (!is_number || !std::isfinite(value)) return std::nullopt;
  return value;
}

QString whole_text(double value) { return fixed_text(value, 0); }

QString percent_text(double factor) { return fixed_text(factor * 100.0, 0) + QStringLiteral(" %"); }

QString duration_text(double seconds) {
  constexpr double kLongest = 1e12;  // keeps the cast below defined for any input
  const auto whole = static_cast<qint64>(std::clamp(std::round(seconds), 0.0, kLongest));
  const qint64 hours = whole / 3600;
  const qint64 minutes = whole / 60 % 60;
  const QString rest = u':' + two_digits(whole % 60);
  if (hours == 0) return QString::number(minutes) + rest;
  return QString::number(hours) + u':' + two_digits(minutes) + rest;
}

QString count_text(qulonglong count) {
  QString digits = QString::number(count);
  for (qsizetype at = digits.size() - 3; at > 0; at -= 3) digits.insert(at, kThinSpace);
  return digits;
}

QString unit_text(api::Axis axis) {
  return api::is_rotary(axis) ? QStringLiteral("°") : QStringLiteral("mm");
}

QString work_system_text(int work_system) {
  constexpr int kLastWhole = 6;  // G59
  if (work_system <= kLastWhole) return QStringLiteral("G%1").arg(53 + work_system);
  return QStringLiteral("G59.%1").arg(work_system - kLastWhole);
}

QString file_name_text(std::string_view path) { return to_text(path.substr(path.rfind('/') + 1)); }

}  // namespace cnc::gui
