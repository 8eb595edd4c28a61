#include "gui/program_view.h"

#include <QHelpEvent>
#include <QPainter>
#include <QScrollBar>
#include <QToolTip>
#include <algorithm>

#include "gui/style.h"

namespace cnc::gui {
namespace {

constexpr int kRowHeight = 22;
constexpr int kMargin = 8;
constexpr int kNumberDigits = 6;  // wider numbers take what they need

QColor row_ground(const ProgramModel& model, const QModelIndex& index) {
  if (!index.data(ProgramModel::kProblem).toString().isEmpty()) {
    const bool warning = index.data(ProgramModel::kIsWarning).toBool();
    return QColor::fromRgb(warning ? 0xff5c4a08 : colour::kRed);
  }
  if (index.row() == model.current_row()) return QColor::fromRgb(0xff14593d);
  return {};
}

}  // namespace

ProgramView::ProgramView(ProgramModel& model, QWidget* parent)
    : QAbstractScrollArea(parent), model_(model) {
  setFocusPolicy(Qt::NoFocus);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOn);
  setMinimumHeight(4 * kRowHeight);
  connect(&model_, &QAbstractItemModel::modelReset, this, [this] {
    follows_ = true;
    update_range();
    verticalScrollBar()->setValue(0);
    viewport()->update();
  });
  connect(&model_, &QAbstractItemModel::dataChanged, this, [this] { viewport()->update(); });
}

int ProgramView::first_visible_row() const { return verticalScrollBar()->value(); }

int ProgramView::visible_rows() const { return std::max(1, viewport()->height() / kRowHeight); }

bool ProgramView::is_visible(int row) const {
  return row >= first_visible_row() && row < first_visible_row() + visible_rows();
}

void ProgramView::go_to(int row) {
  scrolls_itself_ = true;
  verticalScrollBar()->setValue(row - visible_rows() / 2);
  scrolls_itself_ = false;
}

void ProgramView::follow_current_line() {
  const int row = model_.current_row();
  if (follows_ && row >= 0 && !is_visible(row)) go_to(row);
}

void ProgramView::update_range() {
  verticalScrollBar()->setPageStep(visible_rows());
  verticalScrollBar()->setRange(0, std::max(0, model_.rowCount() - visible_rows()));
}

void ProgramView::resizeEvent(QResizeEvent* event) {
  QAbstractScrollArea::resizeEvent(event);
  update_range();
}

void ProgramView::scrollContentsBy(int /*dx*/, int /*dy*/) {
  if (!scrolls_itself_) follows_ = model_.current_row() < 0 || is_visible(model_.current_row());
  viewport()->update();
}

bool ProgramView::viewportEvent(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return QAbstractScrollArea::viewportEvent(event);
  const auto& help = static_cast<const QHelpEvent&>(*event);
  const int row = first_visible_row() + help.pos().y() / kRowHeight;
  QToolTip::showText(help.globalPos(), model_.index(row).data(Qt::ToolTipRole).toString(), this);
  return true;
}

void ProgramView::paintEvent(QPaintEvent*) {
  QPainter painter(viewport());
  const int first = first_visible_row();
  const int last = std::min(first + visible_rows(), model_.rowCount() - 1);  // one may be cut off
  model_.look_at(first, last);
  for (int row = first; row <= last; ++row) {
    paint_row(painter, {0, (row - first) * kRowHeight, viewport()->width(), kRowHeight}, row);
  }
}

void ProgramView::paint_row(QPainter& painter, const QRect& place, int row) const {
  const QModelIndex index = model_.index(row);
  const bool current = row == model_.current_row();
  if (const QColor ground = row_ground(model_, index); ground.isValid()) {
    painter.fillRect(place, ground);
  }
  const QString number = QString::number(row + 1).rightJustified(kNumberDigits);
  const QString mark = current ? QStringLiteral("▶") : QString();
  const QColor text = QColor::fromRgb(isEnabled() ? colour::kText : colour::kOffText);
  const int number_end =
      kMargin + painter.fontMetrics().horizontalAdvance(number + QStringLiteral("  "));

  painter.setPen(QColor::fromRgb(isEnabled() ? colour::kDimText : colour::kOffText));
  painter.drawText(place.adjusted(kMargin, 0, 0, 0), Qt::AlignVCenter, number);
  painter.setPen(text);
  painter.drawText(place.adjusted(number_end, 0, 0, 0), Qt::AlignVCenter, mark);
  const int text_start = number_end + painter.fontMetrics().horizontalAdvance(QStringLiteral("▶ "));
  painter.drawText(place.adjusted(text_start, 0, -kMargin, 0),
                   Qt::AlignVCenter | Qt::TextSingleLine, index.data().toString());
}

}  // namespace cnc::gui
