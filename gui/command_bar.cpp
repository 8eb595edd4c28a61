#include "gui/command_bar.h"

#include <QHBoxLayout>
#include <chrono>
#include <utility>

#include "gui/state_look.h"
#include "gui/style.h"

namespace cnc::gui {
namespace {

constexpr int kHeight = 64;
constexpr auto kHold = std::chrono::seconds(1);

}  // namespace

CommandBar::CommandBar(QWidget* parent)
    : QWidget(parent),
      reset_(new CommandButton(tr("F1\nReset"), this)),
      home_(new CommandButton(tr("⌂\nHome all"), this)),
      accept_(new CommandButton(tr("✓\nHold: accept"), this)),
      load_(new CommandButton(tr("⏏\nLoad…"), this)),
      rewind_(new CommandButton(tr("↺\nRewind"), this)),
      user_(new CommandButton(tr("▴\nUser keys"), this)) {
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(8);
  for (CommandButton* const button : {reset_, home_, load_, rewind_, user_, accept_}) {
    button->setFixedHeight(kHeight);
    row->addWidget(button);
  }
  reset_->setObjectName(QStringLiteral("reset"));
  home_->setObjectName(QStringLiteral("home_all"));
  accept_->setObjectName(QStringLiteral("accept_position"));
  // The others must not move under a finger.
  QSizePolicy place = accept_->sizePolicy();
  place.setRetainSizeWhenHidden(true);
  accept_->setSizePolicy(place);
  accept_->hide();
  load_->setObjectName(QStringLiteral("load"));
  rewind_->setObjectName(QStringLiteral("rewind"));
  user_->setObjectName(QStringLiteral("user_keys"));
  user_->setCheckable(true);
  connect(reset_, &QPushButton::clicked, this, [this] { emit requested(Reset{}); });
  connect(home_, &QPushButton::clicked, this, [this] { emit requested(Home{}); });
  hold_.setSingleShot(true);
  hold_.setInterval(kHold);
  connect(accept_, &QPushButton::pressed, &hold_, qOverload<>(&QTimer::start));
  connect(accept_, &QPushButton::released, &hold_, &QTimer::stop);
  connect(&hold_, &QTimer::timeout, this, [this] { emit requested(AcceptPosition{doubtful_}); });
  connect(load_, &QPushButton::clicked, this, &CommandBar::load_wanted);
  connect(rewind_, &QPushButton::clicked, this, [this] { emit requested(Rewind{}); });
  connect(user_, &QPushButton::toggled, this, &CommandBar::user_keys_wanted);
}

void CommandBar::show_status(const api::MachineStatus& status) {
  reset_->show_availability(status.availability(api::Command::reset));
  home_->show_availability(status.availability(api::Command::home));
  accept_->show_availability(status.availability(api::Command::accept_position));
  show_doubt(status);
  load_->show_availability(status.availability(api::Command::load));
  rewind_->show_availability(status.availability(api::Command::rewind));
  const auto next = look_of(status.state).next;
  reset_->set_awaited(next == api::Command::reset);
  home_->set_awaited(next == api::Command::home);
}

/// Axes of which nothing is known stay out of it. A key that is held when something else comes into
/// doubt has to be held anew.
void CommandBar::show_doubt(const api::MachineStatus& status) {
  std::vector<api::Axis> doubtful;
  for (const api::Axis axis : api::kAllAxes) {
    if (status.trust[axis] == api::PositionTrust::doubtful) doubtful.push_back(axis);
  }
  accept_->setVisible(!doubtful.empty());
  if (!accept_->isEnabled() || doubtful != doubtful_) hold_.stop();
  doubtful_ = std::move(doubtful);
}

}  // namespace cnc::gui
