// The jog pad: a cross for X and Y, a column for each other axis, and a row that says what a key
// does: go on while it is held, at 10, 50 or 100 %, or make one step.
#pragma once

#include <QButtonGroup>
#include <QGridLayout>
#include <QLabel>
#include <QWidget>
#include <vector>

#include "api/status.h"
#include "gui/jog_button.h"
#include "gui/jog_lease.h"
#include "gui/request.h"

namespace cnc::gui {

class JogPanel : public QWidget {
  Q_OBJECT

 public:
  /// `lease` has to outlive this object.
  explicit JogPanel(JogLease& lease, QWidget* parent = nullptr);

  void show_axes(const std::vector<api::Axis>& axes);
  void show_status(const api::MachineStatus& status);
  /// Whether the arrow keys of the keyboard jog now.
  void show_keys_armed(bool armed);

 signals:
  void requested(const cnc::gui::Request& request);

 private:
  void add_axis(api::Axis axis);
  JogButton* add_button(api::Axis axis, double direction);
  void move(const JogButton& button, api::Axis axis, double direction);
  [[nodiscard]] QWidget* make_mode_row();

  JogLease& lease_;
  QButtonGroup* modes_;
  QGridLayout* pad_;
  QLabel* lamp_;
  std::vector<JogButton*> buttons_;
};

}  // namespace cnc::gui
