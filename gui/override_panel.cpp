#include "gui/override_panel.h"

#include <QLabel>
#include <algorithm>
#include <cmath>

#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {
namespace {

constexpr double kStep = 0.1;
constexpr int kHeight = 44;

struct Override {
  const char* name;
  double api::MachineStatus::*status;
  std::optional<double> api::OverrideChange::*change;
  double most;  ///< the API's limit
};

constexpr std::array<Override, OverridePanel::kRowCount> kOverrides{{
    {"Feed", &api::MachineStatus::feed_override, &api::OverrideChange::feed, 3.0},
    {"Rapid", &api::MachineStatus::rapid_override, &api::OverrideChange::rapid, 1.0},
    {"Spindle", &api::MachineStatus::speed_override, &api::OverrideChange::speed, 3.0},
}};

// To whole steps, so that 0.95 goes to 1.0 and not to 1.05.
double step_from(double factor, double direction) {
  const double steps = factor / kStep;
  constexpr double kAlmost = 1e-6;
  const double next =
      direction > 0.0 ? std::floor(steps + kAlmost) + 1.0 : std::ceil(steps - kAlmost) - 1.0;
  return next * kStep;
}

}  // namespace

OverridePanel::OverridePanel(QWidget* parent) : QWidget(parent) {
  auto* const grid = new QGridLayout(this);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(4);
  grid->setColumnStretch(2, 1);
  for (std::size_t index = 0; index < rows_.size(); ++index) add_row(*grid, index);
}

void OverridePanel::add_row(QGridLayout& grid, std::size_t index) {
  Row& row = rows_.at(index);
  row = {new CommandButton(QStringLiteral("−"), this), new CommandButton(percent_text(1.0), this),
         new CommandButton(QStringLiteral("+"), this)};
  const QString name = QString::fromLatin1(kOverrides.at(index).name);
  row.less->setObjectName(name + QStringLiteral("_less"));
  row.value->setObjectName(name + QStringLiteral("_value"));
  row.more->setObjectName(name + QStringLiteral("_more"));

  const int line = static_cast<int>(index);
  grid.addWidget(new QLabel(name, this), line, 0);
  int column = 1;
  for (CommandButton* const button : {row.less, row.value, row.more}) {
    button->setFixedHeight(kHeight);
    grid.addWidget(button, line, column++);
  }
  row.less->setFixedWidth(84);
  row.more->setFixedWidth(84);
  connect(row.less, &QPushButton::clicked, this,
          [this, index] { ask(index, step_from(rows_.at(index).factor, -1.0)); });
  connect(row.value, &QPushButton::clicked, this, [this, index] { ask(index, 1.0); });
  connect(row.more, &QPushButton::clicked, this,
          [this, index] { ask(index, step_from(rows_.at(index).factor, 1.0)); });
}

void OverridePanel::ask(std::size_t index, double factor) {
  const Override& override = kOverrides.at(index);
  Row& row = rows_.at(index);
  // Kept at once, so that two quick taps are two steps even before the next status.
  row.factor = std::clamp(factor, 0.0, override.most);
  api::OverrideChange change;
  change.*override.change = row.factor;
  emit requested(SetOverrides{change});
}

void OverridePanel::show_status(const api::MachineStatus& status) {
  const api::CommandAvailability& availability = status.availability(api::Command::override_rates);
  for (std::size_t index = 0; index < rows_.size(); ++index) {
    Row& row = rows_.at(index);
    row.factor = status.*kOverrides.at(index).status;
    set_text(*row.value, percent_text(row.factor));
    const bool usual = std::abs(row.factor - 1.0) < 0.005;
    set_look(*row.value, "tone", usual ? QString() : QStringLiteral("yellow"));
    for (CommandButton* const button : {row.less, row.value, row.more}) {
      button->show_availability(availability);
    }
  }
}

}  // namespace cnc::gui
