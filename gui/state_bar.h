// The top row: what the machine does, in a word, a shape and a colour; what it waits for; and which
// machine this is.
#pragma once

#include <QLabel>
#include <QWidget>

#include "api/status.h"

namespace cnc::gui {

class StateBar : public QWidget {
  Q_OBJECT

 public:
  explicit StateBar(QWidget* parent = nullptr);

  void show_status(const api::MachineStatus& status);
  /// `name`: what is connected, for example "virtual CPU5 board".
  void show_connected(const QString& name);
  void show_disconnected(const QString& address, const QString& reason);

 private:
  QLabel* state_;
  QLabel* text_;
  QLabel* probe_;
  QLabel* machine_;
};

}  // namespace cnc::gui
