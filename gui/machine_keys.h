// Keys that work everywhere, whatever has the focus: F1 resets, Esc pauses. They watch the whole
// application, so that no dialog and no editor can swallow them; Esc then also does what it does
// there.
#pragma once

#include <QObject>

#include "gui/request.h"

namespace cnc::gui {

class MachineKeys : public QObject {
  Q_OBJECT

 public:
  explicit MachineKeys(QObject* parent = nullptr);

  bool eventFilter(QObject* watched, QEvent* event) override;

 signals:
  void requested(const cnc::gui::Request& request);
};

}  // namespace cnc::gui
