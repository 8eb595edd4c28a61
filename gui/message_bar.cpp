#include "gui/message_bar.h"

#include <QDateTime>
#include <QHBoxLayout>
#include <array>
#include <chrono>

#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr int kHeight = 40;
constexpr int kListHeight = 320;

struct SeverityLook {
  const char* mark;
  const char* tone;
};
// In the order of api::Severity.
constexpr std::array<SeverityLook, 3> kLooks{{{"●", "grey"}, {"▲", "yellow"}, {"✖", "red"}}};

const SeverityLook& look_of(api::Severity severity) {
  return kLooks.at(static_cast<std::size_t>(severity));
}

QString time_text(const api::Message& message) {
  const qint64 ms = message.time.time_since_epoch().count();
  return QDateTime::fromMSecsSinceEpoch(ms).toString(QStringLiteral("HH:mm:ss"));
}

QString whole_text_of(const api::Message& message) {
  QString text = to_text(message.text);
  if (message.error && !message.error->check.empty()) {
    text += QStringLiteral("  →  ") + to_text(message.error->check);
  }
  return text;
}

}  // namespace

MessageBar::MessageBar(QWidget* parent)
    : QWidget(parent),
      mark_(new QLabel(this)),
      line_(new QLabel(this)),
      acknowledge_(new QPushButton(tr("✓ Seen"), this)),
      toggle_(new QPushButton(tr("Messages"), this)),
      list_(new QListWidget(parent)) {
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(8);
  row->addWidget(mark_);
  row->addWidget(line_, 1);
  row->addWidget(acknowledge_);
  row->addWidget(toggle_);
  mark_->setFixedSize(64, kHeight);
  mark_->setAlignment(Qt::AlignCenter);
  mark_->setProperty("role", "mark");
  mark_->setObjectName(QStringLiteral("message_mark"));
  line_->setFixedHeight(kHeight);
  line_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  line_->setWordWrap(true);
  line_->setTextFormat(Qt::PlainText);
  line_->setObjectName(QStringLiteral("message_line"));
  acknowledge_->setObjectName(QStringLiteral("message_seen"));
  toggle_->setObjectName(QStringLiteral("message_toggle"));
  list_->setObjectName(QStringLiteral("message_list"));
  for (QPushButton* const button : {acknowledge_, toggle_}) {
    button->setFixedSize(112, kHeight);
    button->setFocusPolicy(Qt::NoFocus);
  }
  acknowledge_->hide();
  toggle_->setCheckable(true);
  list_->hide();
  list_->setFocusPolicy(Qt::NoFocus);
  list_->setWordWrap(true);
  list_->setSelectionMode(QAbstractItemView::NoSelection);
  connect(acknowledge_, &QPushButton::clicked, this, &MessageBar::acknowledge);
  connect(toggle_, &QPushButton::clicked, this, &MessageBar::toggle_list);
}

void MessageBar::add(const api::Message& message) {
  auto* const item = new QListWidgetItem(QStringLiteral("%1  %2  %3")
                                             .arg(time_text(message),
                                                  QString::fromUtf8(look_of(message.severity).mark),
                                                  whole_text_of(message)));
  list_->insertItem(0, item);  // newest on top
  if (list_->count() > kMostMessages) delete list_->takeItem(kMostMessages);
  ++unacknowledged_;
  // A later message of less weight does not hide an error that nobody has seen.
  if (!shown_ || message.severity >= *shown_) show_newest(message);
  set_text(
      *mark_,
      QStringLiteral("%1 %2").arg(QString::fromUtf8(look_of(*shown_).mark)).arg(unacknowledged_));
}

void MessageBar::add_error(const QString& what, const api::Error& error) {
  const std::string text = what.toStdString() + ": " + error.to_string();
  const auto now = std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
  add({0, now, api::Severity::error, text, error});
}

void MessageBar::show_newest(const api::Message& message) {
  shown_ = message.severity;
  set_look(*mark_, "tone", QString::fromLatin1(look_of(message.severity).tone));
  line_->setText(whole_text_of(message));
  line_->setToolTip(whole_text_of(message));
  acknowledge_->show();
}

void MessageBar::acknowledge() {
  unacknowledged_ = 0;
  shown_.reset();
  mark_->clear();
  set_look(*mark_, "tone", QString());
  line_->clear();
  line_->setToolTip({});
  acknowledge_->hide();
}

void MessageBar::toggle_list() {
  if (!toggle_->isChecked()) return list_->hide();
  list_->setGeometry(x(), geometry().bottom() + 4, width(), kListHeight);
  list_->raise();
  list_->show();
}

}  // namespace cnc::gui
