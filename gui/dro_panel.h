// The read-outs: work position large and machine position small, for each visible axis, with its
// homed mark (a key that homes the axis) and the key that makes here its work zero; below, feed,
// spindle and what is active.
#pragma once

#include <QGridLayout>
#include <QLabel>
#include <QWidget>
#include <vector>

#include "gui/command_button.h"
#include "gui/read_out.h"
#include "gui/request.h"

namespace cnc::gui {

class DroPanel : public QWidget {
  Q_OBJECT

 public:
  explicit DroPanel(QWidget* parent = nullptr);

  void show_axes(const std::vector<api::Axis>& axes);
  void show_status(const api::MachineStatus& status);

 signals:
  void requested(const cnc::gui::Request& request);

 private:
  struct Row {
    api::Axis axis;
    QWidget* widget;
    CommandButton* home;
    ReadOut* work;
    QLabel* machine;
    CommandButton* zero;
  };

  [[nodiscard]] Row make_row(api::Axis axis);
  static void show_row(const Row& row, const api::MachineStatus& status);

  QLabel* header_;
  QGridLayout* grid_;
  QLabel* motion_;
  QLabel* codes_;
  std::vector<Row> rows_;
};

}  // namespace cnc::gui
