#include "gui/dro_panel.h"

#include <QHBoxLayout>
#include <QVBoxLayout>

#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr int kKeySize = 48;
constexpr int kSecondsPerMinute = 60;

QString header_text(const api::MachineStatus& status) {
  return DroPanel::tr("Work %1  ·  mm  ·  T%2")
      .arg(work_system_text(status.work_system))
      .arg(status.tool);
}

QString spindle_text(const api::MachineStatus& status) {
  const QString speed = whole_text(status.spindle_speed);
  switch (status.spindle) {
    case api::SpindleDirection::off:
      return DroPanel::tr("S off");
    case api::SpindleDirection::clockwise:
      return DroPanel::tr("S ↻ %1 rpm").arg(speed);
    case api::SpindleDirection::counterclockwise:
      return DroPanel::tr("S ↺ %1 rpm").arg(speed);
  }
  return {};
}

QString motion_text(const api::MachineStatus& status) {
  QString text = DroPanel::tr("F %1").arg(whole_text(status.feed * kSecondsPerMinute));
  if (status.programmed_feed > 0.0) {
    text += DroPanel::tr(" of %1").arg(whole_text(status.programmed_feed * kSecondsPerMinute));
  }
  text += DroPanel::tr(" mm/min    %1").arg(spindle_text(status));
  if (status.flood) text += DroPanel::tr("    ● flood");
  if (status.mist) text += DroPanel::tr("    ● mist");
  return text;
}

QString machine_text(double position, api::PositionTrust trust) {
  switch (trust) {
    case api::PositionTrust::trusted:
      return position_text(position) + u'\n' + DroPanel::tr("machine");
    case api::PositionTrust::doubtful:
      return position_text(position) + u'\n' + DroPanel::tr("doubtful");
    case api::PositionTrust::unknown:
      break;
  }
  return DroPanel::tr("not\nhomed");
}

}  // namespace

DroPanel::DroPanel(QWidget* parent)
    : QWidget(parent),
      header_(new QLabel(this)),
      grid_(new QGridLayout),
      motion_(new QLabel(this)),
      codes_(new QLabel(this)) {
  auto* const column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(4);
  column->addWidget(header_);
  column->addLayout(grid_, 1);
  column->addWidget(motion_);
  column->addWidget(codes_);
  grid_->setSpacing(4);
  header_->setProperty("role", "header");
  motion_->setProperty("role", "value");
  codes_->setProperty("role", "note");
  // Whatever the program switches on: the row of codes must not widen the window.
  for (QLabel* const label : {header_, motion_, codes_}) {
    label->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  }
}

void DroPanel::show_axes(const std::vector<api::Axis>& axes) {
  for (const Row& row : rows_) delete row.widget;
  rows_.clear();
  for (const api::Axis axis : axes) {
    rows_.push_back(make_row(axis));
    grid_->addWidget(rows_.back().widget, static_cast<int>(rows_.size()) - 1, 0);
  }
}

DroPanel::Row DroPanel::make_row(api::Axis axis) {
  const QString name = to_text(api::name_of(axis));
  auto* const widget = new QWidget(this);
  auto* const home = new CommandButton(QStringLiteral("⌂"), widget);
  auto* const letter = new QLabel(name, widget);
  auto* const work = new ReadOut(widget);
  auto* const machine = new QLabel(widget);
  auto* const zero = new CommandButton(QStringLiteral("0"), widget);

  auto* const line = new QHBoxLayout(widget);
  line->setContentsMargins(0, 0, 0, 0);
  line->setSpacing(6);
  line->addWidget(home);
  line->addWidget(letter);
  line->addWidget(work, 1);
  line->addWidget(machine);
  line->addWidget(zero);

  home->setFixedWidth(kKeySize);
  home->setMinimumHeight(40);
  home->setSizePolicy(QSizePolicy::Fixed, QSizePolicy::MinimumExpanding);
  home->setMaximumHeight(kKeySize);
  zero->setFixedWidth(kKeySize);
  zero->setMinimumHeight(40);
  zero->setMaximumHeight(kKeySize);
  zero->setSizePolicy(QSizePolicy::Fixed, QSizePolicy::MinimumExpanding);
  letter->setProperty("role", "axis");
  machine->setProperty("role", "machine");
  machine->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  machine->setFixedWidth(88);
  home->setObjectName(QStringLiteral("home_") + name);
  zero->setObjectName(QStringLiteral("zero_") + name);
  work->setObjectName(QStringLiteral("work_") + name);
  machine->setObjectName(QStringLiteral("machine_") + name);

  connect(home, &QPushButton::clicked, this, [this, axis] { emit requested(Home{{axis}}); });
  connect(zero, &QPushButton::clicked, this, [this, axis] {
    emit requested(SetWorkZero{{{axis, 0.0}}});
  });
  return {axis, widget, home, work, machine, zero};
}

void DroPanel::show_status(const api::MachineStatus& status) {
  set_text(*header_, header_text(status));
  set_text(*motion_, motion_text(status));
  set_text(*codes_, to_text(status.active_codes));
  for (const Row& row : rows_) show_row(row, status);
}

void DroPanel::show_row(const Row& row, const api::MachineStatus& status) {
  const api::PositionTrust trust = status.trust[row.axis];
  const bool trusted = trust == api::PositionTrust::trusted;
  row.work->show_value(status.work_position[row.axis]);
  row.work->set_trusted(trusted);
  set_text(*row.machine, machine_text(status.machine_position[row.axis], trust));
  set_look(*row.machine, "tone", trusted ? QString() : QStringLiteral("yellow"));
  set_text(*row.home, trusted ? QStringLiteral("⌂") : QStringLiteral("⌂?"));
  set_look(*row.home, "homed", trusted ? QStringLiteral("yes") : QStringLiteral("no"));
  row.home->show_availability(status.availability(api::Command::home));
  row.zero->show_availability(status.availability(api::Command::set_work_zero));
}

}  // namespace cnc::gui
