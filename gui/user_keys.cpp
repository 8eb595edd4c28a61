#include "gui/user_keys.h"

#include <QHBoxLayout>
#include <string>

namespace cnc::gui {
namespace {

constexpr int kHeight = 56;

}  // namespace

UserKeys::UserKeys(QWidget* parent) : QWidget(parent) {
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(8);
  int number = 0;
  for (CommandButton*& key : keys_) {
    ++number;
    const std::string sub = "user_" + std::to_string(number);
    key = new CommandButton(tr("user\n%1").arg(number), this);
    key->setFixedHeight(kHeight);
    key->setObjectName(QString::fromStdString(sub));
    connect(key, &QPushButton::clicked, this, [this, sub] { emit requested(RunSub{sub}); });
    row->addWidget(key);
  }
}

void UserKeys::show_status(const api::MachineStatus& status) {
  for (CommandButton* const key : keys_) {
    key->show_availability(status.availability(api::Command::mdi));
  }
}

}  // namespace cnc::gui
