#include "gui/mdi_line.h"

#include <QHBoxLayout>
#include <QToolTip>
#include <algorithm>

namespace cnc::gui {
namespace {

constexpr int kHeight = 44;
constexpr int kMostCharacters = 4096;  // the API's limit

}  // namespace

void HistoryEdit::remember() {
  if (history_.isEmpty() || history_.last() != text()) history_.append(text());
  if (history_.size() > kMostEntries) history_.removeFirst();
  recalled_ = history_.size();
  clear();
}

void HistoryEdit::keyPressEvent(QKeyEvent* event) {
  if (event->key() == Qt::Key_Up) return recall(recalled_ - 1);
  if (event->key() == Qt::Key_Down) return recall(recalled_ + 1);
  QLineEdit::keyPressEvent(event);
}

void HistoryEdit::recall(qsizetype index) {
  recalled_ = std::clamp<qsizetype>(index, 0, history_.size());
  setText(recalled_ < history_.size() ? history_.at(recalled_) : QString());
}

MdiLine::MdiLine(QWidget* parent)
    : QWidget(parent), editor_(new HistoryEdit(this)), send_(new CommandButton(tr("Do it"), this)) {
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(8);
  row->addWidget(editor_, 1);
  row->addWidget(send_);
  editor_->setFixedHeight(kHeight);
  editor_->setMaxLength(kMostCharacters);
  editor_->setPlaceholderText(tr("Single line of G-code"));
  // Only a tap brings the keyboard here; otherwise the arrow keys are for jogging.
  editor_->setFocusPolicy(Qt::ClickFocus);
  editor_->setObjectName(QStringLiteral("mdi"));
  send_->setFixedSize(96, kHeight);
  send_->setObjectName(QStringLiteral("mdi_send"));
  connect(editor_, &QLineEdit::returnPressed, this, &MdiLine::send);
  connect(send_, &QPushButton::clicked, this, &MdiLine::send);
}

void MdiLine::show_status(const api::MachineStatus& status) {
  send_->show_availability(status.availability(api::Command::mdi));
}

void MdiLine::send() {
  const QString line = editor_->text().trimmed();
  if (line.isEmpty()) return;
  if (!send_->isEnabled()) {  // what was typed stays
    QToolTip::showText(editor_->mapToGlobal(QPoint(0, 0)), send_->toolTip(), editor_);
    return;
  }
  editor_->remember();
  emit requested(Mdi{line.toStdString()});
}

}  // namespace cnc::gui
