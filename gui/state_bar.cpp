#include "gui/state_bar.h"

#include <QHBoxLayout>

#include "gui/state_look.h"
#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr int kHeight = 48;
constexpr int kStateWidth = 220;

}  // namespace

StateBar::StateBar(QWidget* parent)
    : QWidget(parent),
      state_(new QLabel(this)),
      text_(new QLabel(this)),
      probe_(new QLabel(this)),
      machine_(new QLabel(this)) {
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(12);
  row->addWidget(state_);
  row->addWidget(text_, 1);
  row->addWidget(probe_);
  row->addWidget(machine_);
  state_->setFixedHeight(kHeight);
  state_->setMinimumWidth(kStateWidth);
  state_->setAlignment(Qt::AlignCenter);
  state_->setProperty("role", "state");
  state_->setObjectName(QStringLiteral("state"));
  text_->setWordWrap(true);
  text_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  text_->setObjectName(QStringLiteral("state_text"));
  probe_->setProperty("role", "lamp");
  probe_->setObjectName(QStringLiteral("probe"));
  machine_->setProperty("role", "note");
  machine_->setObjectName(QStringLiteral("machine"));
}

void StateBar::show_status(const api::MachineStatus& status) {
  const StateLook& look = look_of(status.state);
  set_text(*state_, QString::fromUtf8(look.shape) + QStringLiteral("  ") + tr(look.word));
  set_look(*state_, "tone", QString::fromLatin1(look.tone));
  set_text(*text_, to_text(status.state_text));
  set_text(*probe_, status.probe_input ? tr("● probe touches") : tr("○ probe"));
  set_look(*probe_, "tone", status.probe_input ? QStringLiteral("yellow") : QStringLiteral("grey"));
}

void StateBar::show_connected(const QString& name) { set_text(*machine_, name); }

void StateBar::show_disconnected(const QString& address, const QString& reason) {
  set_text(*state_, tr("○  No connection"));
  set_look(*state_, "tone", QStringLiteral("grey"));
  set_text(*text_, tr("Not connected to %1 — trying again").arg(address));
  text_->setToolTip(reason);
  set_text(*probe_, QString());
  set_text(*machine_, QString());
}

}  // namespace cnc::gui
