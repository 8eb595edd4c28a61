// The line for single blocks of G-code, with a history on the up and down keys.
#pragma once

#include <QKeyEvent>
#include <QLineEdit>
#include <QStringList>
#include <QWidget>

#include "gui/command_button.h"
#include "gui/request.h"

namespace cnc::gui {

/// An editor that remembers what was entered.
class HistoryEdit : public QLineEdit {
  Q_OBJECT

 public:
  static constexpr qsizetype kMostEntries = 100;

  using QLineEdit::QLineEdit;

  /// Keeps the text as the newest entry and clears the editor.
  void remember();

 protected:
  void keyPressEvent(QKeyEvent* event) override;

 private:
  void recall(qsizetype index);

  QStringList history_;     // oldest first
  qsizetype recalled_ = 0;  // history_.size(): none
};

class MdiLine : public QWidget {
  Q_OBJECT

 public:
  explicit MdiLine(QWidget* parent = nullptr);

  void show_status(const api::MachineStatus& status);

 signals:
  void requested(const cnc::gui::Request& request);

 private:
  void send();

  HistoryEdit* editor_;
  CommandButton* send_;
};

}  // namespace cnc::gui
