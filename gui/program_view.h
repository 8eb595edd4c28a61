// Shows the lines of a ProgramModel: number, text, the line in execution, and lines that are wrong.
//
// Paints the visible rows itself. Qt's item views keep data for every row: 77 MB for ten million
// lines in the best of them, this one nothing.
#pragma once

#include <QAbstractScrollArea>

#include "gui/program_model.h"

namespace cnc::gui {

class ProgramView : public QAbstractScrollArea {
  Q_OBJECT

 public:
  /// `model` has to outlive this object.
  explicit ProgramView(ProgramModel& model, QWidget* parent = nullptr);

  /// Scrolls so that the row is in the middle.
  void go_to(int row);
  /// Keeps the line in execution in view, unless the operator has scrolled away from it.
  void follow_current_line();
  [[nodiscard]] int first_visible_row() const;
  [[nodiscard]] int visible_rows() const;

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void scrollContentsBy(int dx, int dy) override;
  bool viewportEvent(QEvent* event) override;

 private:
  void update_range();
  [[nodiscard]] bool is_visible(int row) const;
  void paint_row(QPainter& painter, const QRect& place, int row) const;

  ProgramModel& model_;
  bool follows_ = true;
  bool scrolls_itself_ = false;
};

}  // namespace cnc::gui
