// The keys user 1 to user 10, in two rows: each runs the sub of that name of the macro files.
#pragma once

#include <QWidget>
#include <array>

#include "gui/command_button.h"
#include "gui/request.h"

namespace cnc::gui {

class UserKeys : public QWidget {
  Q_OBJECT

 public:
  static constexpr int kCount = 10;

  explicit UserKeys(QWidget* parent = nullptr);

  void show_status(const api::MachineStatus& status);

 signals:
  void requested(const cnc::gui::Request& request);

 private:
  std::array<CommandButton*, kCount> keys_{};
};

}  // namespace cnc::gui
