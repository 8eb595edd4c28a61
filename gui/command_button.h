// A key for one command of the machine. The server says whether the command is possible now; when
// it is not, the key is grey and says why, to a pointer that rests on it and to a finger.
#pragma once

#include <QPushButton>

#include "api/status.h"

namespace cnc::gui {

class CommandButton : public QPushButton {
  Q_OBJECT

 public:
  explicit CommandButton(const QString& text, QWidget* parent = nullptr);

  void show_availability(const api::CommandAvailability& availability);
  /// A blue edge: this is what the operator does next.
  void set_awaited(bool awaited);

 protected:
  bool event(QEvent* event) override;
};

}  // namespace cnc::gui
