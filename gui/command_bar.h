// The bottom row, there on every page: reset and home.
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

 private:
  CommandButton* reset_;
  CommandButton* home_;
  CommandButton* load_;
  CommandButton* rewind_;
};

}  // namespace cnc::gui
