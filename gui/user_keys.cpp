#include "gui/user_keys.h"

#include <QGridLayout>
#include <string>

namespace cnc::gui {
namespace {

constexpr int kHeight = 44;
constexpr int kInRow = 5;

}  // namespace

UserKeys::UserKeys(QWidget* parent) : QWidget(parent) {
  auto* const grid = new QGridLayout(this);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(8);
  int number = 0;
  for (CommandButton*& key : keys_) {
    ++number;
    const std::string sub = "user_" + std::to_string(number);
    key = new CommandButton(tr("user %1").arg(number), this);
    key->setFixedHeight(kHeight);
    key->setObjectName(QString::fromStdString(sub));
    connect(key, &QPushButton::clicked, this, [this, sub] { emit requested(RunSub{sub}); });
    grid->addWidget(key, (number - 1) / kInRow, (number - 1) % kInRow);
  }
}

void UserKeys::show_status(const api::MachineStatus& status) {
  for (CommandButton* const key : keys_) {
    key->show_availability(status.availability(api::Command::mdi));
  }
}

}  // namespace cnc::gui
