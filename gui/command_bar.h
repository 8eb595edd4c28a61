// The bottom row: reset, home, load, rewind, and the key that opens the user keys. While positions
// of axes are in doubt there is a key that trusts them again; it has to be held, because a position
// that is wrong breaks tools.
#pragma once

#include <QTimer>
#include <QWidget>
#include <vector>

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
  void show_doubt(const api::MachineStatus& status);

  CommandButton* reset_;
  CommandButton* home_;
  CommandButton* accept_;
  CommandButton* load_;
  CommandButton* rewind_;
  CommandButton* user_;
  QTimer hold_;
  std::vector<api::Axis> doubtful_;
};

}  // namespace cnc::gui
