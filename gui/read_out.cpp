#include "gui/read_out.h"

#include <QFontMetrics>
#include <QPainter>
#include <algorithm>

#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr double kWidestValue = -1234.567;
constexpr int kSmallest = 24;  // px
constexpr double kPartOfHeight = 0.86;

}  // namespace

ReadOut::ReadOut(QWidget* parent) : QWidget(parent), text_(position_text(0.0)) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
  setMinimumSize(160, 40);
}

void ReadOut::show_value(double value) {
  const QString text = position_text(value);
  if (text == text_) return;
  text_ = text;
  update();
}

void ReadOut::set_trusted(bool trusted) {
  if (trusted == trusted_) return;
  trusted_ = trusted;
  update();
}

void ReadOut::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  constexpr int kTrial = 100;
  digits_ = font();
  digits_.setPixelSize(kTrial);
  const int trial_width = QFontMetrics(digits_).horizontalAdvance(position_text(kWidestValue));
  const int by_width = width() * kTrial / std::max(trial_width, 1);
  const int by_height = static_cast<int>(height() * kPartOfHeight);
  digits_.setPixelSize(std::max(kSmallest, std::min(by_width, by_height)));
}

void ReadOut::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setFont(digits_);
  const QRgb ink = !isEnabled() ? colour::kOffText : trusted_ ? colour::kText : colour::kGrey;
  painter.setPen(QColor::fromRgb(ink));
  painter.drawText(rect(), Qt::AlignRight | Qt::AlignVCenter, text_);
}

}  // namespace cnc::gui
