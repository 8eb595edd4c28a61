// Run, pause, stop. The first key says what it will do next: one key that starts a job or goes on
// after a tool change, without saying which, has broken probes.
#pragma once

#include <QWidget>

#include "gui/command_button.h"
#include "gui/request.h"

namespace cnc::gui {

/// What the run key does in this status.
struct RunKey {
  QString text;  ///< "Run", "Resume", "Continue", "Continue with T3"
  Request request;
  api::CommandAvailability availability;
};
[[nodiscard]] RunKey run_key(const api::MachineStatus& status);

class JobPanel : public QWidget {
  Q_OBJECT

 public:
  explicit JobPanel(QWidget* parent = nullptr);

  void show_status(const api::MachineStatus& status);

 signals:
  void requested(const cnc::gui::Request& request);

 private:
  CommandButton* run_;
  CommandButton* pause_;
  CommandButton* stop_;
  Request run_request_ = Run{};
};

}  // namespace cnc::gui
