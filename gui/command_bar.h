// The bottom row, always there: reset, home, load, rewind, and the key that opens the user keys.
#pragma once

#include <QWidget>

#include "gui/command_button.h"
#include "gui/request.h"

namespace cnc::gui {

class CommandBar : public QWidget {
  Q_OBJECT

 public:
  explicit CommandBar(QWidget* parent = nullptr);

  void show_status(const api::MachineStatus& status);

 signals:
  void requested(const cnc::gui::Request& request);
  /// Which file to load is still to be asked.
  void load_wanted();
  void user_keys_wanted(bool wanted);

 private:
  CommandButton* reset_;
  CommandButton* home_;
  CommandButton* load_;
  CommandButton* rewind_;
  CommandButton* user_;
};

}  // namespace cnc::gui
