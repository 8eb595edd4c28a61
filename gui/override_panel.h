// Feed, rapid and spindle speed overrides: − and + by ten per cent, a tap on the value for 100 %.
#pragma once

#include <QGridLayout>
#include <QPushButton>
#include <QWidget>
#include <array>

#include "gui/command_button.h"
#include "gui/request.h"

namespace cnc::gui {

class OverridePanel : public QWidget {
  Q_OBJECT

 public:
  static constexpr std::size_t kRowCount = 3;

  explicit OverridePanel(QWidget* parent = nullptr);

  void show_status(const api::MachineStatus& status);

 signals:
  void requested(const cnc::gui::Request& request);

 private:
  struct Row {
    CommandButton* less;
    CommandButton* value;
    CommandButton* more;
    double factor = 1.0;  ///< as asked for last, or as the status says
  };

  void add_row(QGridLayout& grid, std::size_t index);
  void ask(std::size_t index, double factor);

  std::array<Row, kRowCount> rows_{};
};

}  // namespace cnc::gui
