// A number in the largest digits that its place holds, flush right, so that the decimal points of a
// column stand under one another.
#pragma once

#include <QString>
#include <QWidget>

namespace cnc::gui {

class ReadOut : public QWidget {
  Q_OBJECT

 public:
  explicit ReadOut(QWidget* parent = nullptr);

  void show_value(double value);
  /// A position that is not known to be true is shown dim.
  void set_trusted(bool trusted);
  [[nodiscard]] const QString& text() const { return text_; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  QString text_;
  QFont digits_;
  bool trusted_ = false;
};

}  // namespace cnc::gui
