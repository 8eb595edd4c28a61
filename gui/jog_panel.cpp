#include "gui/jog_panel.h"

#include <QHBoxLayout>
#include <QVBoxLayout>
#include <algorithm>
#include <array>

#include "gui/jog_keys.h"
#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr int kKeyWidth = 66;
constexpr int kKeyHeight = 58;
constexpr int kGap = 4;
constexpr int kWideGap = 14;  // between keys that a finger must not confuse

struct Mode {
  const char* text;
  double rate;  ///< of the maximum velocity while held; 0 = a step
  double step;  ///< mm or degrees
};
constexpr std::array kModes{
    Mode{"0.01", 0.0, 0.01}, Mode{"0.1", 0.0, 0.1},  Mode{"1", 0.0, 1.0},
    Mode{"10 %", 0.1, 0.0},  Mode{"50 %", 0.5, 0.0}, Mode{"100 %", 1.0, 0.0},
};
constexpr int kFirstMode = 3;  // slow, while held

struct Cell {
  int row;
  int column;
};

// Columns 0 to 2 hold the cross of X and Y; each other axis has a gap and a column behind it.
Cell cell_of(api::Axis axis, double direction) {
  const bool positive = direction > 0.0;
  if (axis == api::Axis::X) return {1, positive ? 2 : 0};
  if (axis == api::Axis::Y) return {positive ? 0 : 2, 1};
  const int place = static_cast<int>(axis) - static_cast<int>(api::Axis::Z);
  return {positive ? 0 : 2, 4 + 2 * place};
}

QString key_hint(api::Axis axis, double direction) {
  const auto table = jog_key_table();
  const auto found = std::ranges::find_if(
      table, [&](const JogKey& row) { return row.axis == axis && row.direction == direction; });
  return found == table.end() ? QString() : QString::fromUtf8(found->name);
}

QString button_text(api::Axis axis, double direction) {
  const QString sign = direction > 0.0 ? QStringLiteral("+") : QStringLiteral("−");
  const QString text = to_text(api::name_of(axis)) + sign;
  const QString hint = key_hint(axis, direction);
  return hint.isEmpty() ? text : text + u'\n' + hint;
}

}  // namespace

JogPanel::JogPanel(JogLease& lease, QWidget* parent)
    : QWidget(parent),
      lease_(lease),
      modes_(new QButtonGroup(this)),
      pad_(new QGridLayout),
      lamp_(new QLabel(this)) {
  auto* const column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(8);
  column->addWidget(make_mode_row());
  column->addLayout(pad_);
  pad_->setSpacing(kGap);
  lamp_->setAlignment(Qt::AlignCenter);
  lamp_->setObjectName(QStringLiteral("keys_lamp"));
  pad_->addWidget(lamp_, 1, 1);
  show_keys_armed(false);
}

QWidget* JogPanel::make_mode_row() {
  auto* const widget = new QWidget(this);
  auto* const row = new QHBoxLayout(widget);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(kGap);
  row->addWidget(new QLabel(tr("Step"), widget));
  for (int index = 0; index < static_cast<int>(kModes.size()); ++index) {
    if (index == kFirstMode) row->addWidget(new QLabel(tr("  Held"), widget));
    auto* const button = new QPushButton(
        QString::fromLatin1(kModes.at(static_cast<std::size_t>(index)).text), widget);
    button->setCheckable(true);
    button->setChecked(index == kFirstMode);
    button->setFocusPolicy(Qt::NoFocus);
    button->setFixedHeight(44);
    button->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);  // share the row alike
    button->setObjectName(QStringLiteral("mode_") + button->text());
    modes_->addButton(button, index);
    row->addWidget(button, 1);
  }
  connect(modes_, &QButtonGroup::idClicked, this, [this] { lease_.release_all(); });
  return widget;
}

void JogPanel::show_axes(const std::vector<api::Axis>& axes) {
  lease_.release_all();
  for (const JogButton* const button : buttons_) delete button;
  buttons_.clear();
  for (const api::Axis axis : axes) add_axis(axis);
  pad_->setColumnStretch(pad_->columnCount(), 1);
}

void JogPanel::add_axis(api::Axis axis) {
  buttons_.push_back(add_button(axis, 1.0));
  buttons_.push_back(add_button(axis, -1.0));
  const int gap_column = cell_of(axis, 1.0).column - 1;
  if (axis >= api::Axis::Z) pad_->setColumnMinimumWidth(gap_column, kWideGap - 2 * kGap);
}

JogButton* JogPanel::add_button(api::Axis axis, double direction) {
  auto* const button = new JogButton(button_text(axis, direction), this);
  button->setFixedSize(kKeyWidth, kKeyHeight);
  button->setEnabled(false);
  button->setObjectName(to_text(api::name_of(axis)) +
                        (direction > 0.0 ? QStringLiteral("_plus") : QStringLiteral("_minus")));
  const Cell cell = cell_of(axis, direction);
  pad_->addWidget(button, cell.row, cell.column);
  connect(button, &JogButton::held, this,
          [this, button, axis, direction] { move(*button, axis, direction); });
  connect(button, &JogButton::let_go, this, [this, button] { lease_.release(button); });
  return button;
}

void JogPanel::move(const JogButton& button, api::Axis axis, double direction) {
  const Mode& mode = kModes.at(static_cast<std::size_t>(modes_->checkedId()));
  if (mode.rate > 0.0) return lease_.hold(&button, {axis, direction * mode.rate});
  emit requested(JogStep{axis, direction * mode.step});
}

void JogPanel::show_status(const api::MachineStatus& status) {
  const api::CommandAvailability& jog = status.availability(api::Command::jog);
  const QString reason = to_text(jog.reason);
  for (JogButton* const button : buttons_) {
    if (button->isEnabled() != jog.allowed) button->setEnabled(jog.allowed);
    if (button->toolTip() != reason) button->setToolTip(reason);
  }
}

void JogPanel::show_keys_armed(bool armed) {
  set_text(*lamp_, armed ? tr("● keys\njog") : tr("○ keys\ntype"));
  set_look(*lamp_, "tone", armed ? QStringLiteral("green") : QStringLiteral("grey"));
}

}  // namespace cnc::gui
