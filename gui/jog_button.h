// A button that jogs while it is held, with a mouse or a finger.
//
// It takes no focus, so that no key can trigger it. Leaving it, hiding it or disabling it is a
// release, and coming back with the button still pressed does not start again.
#pragma once

#include <QPushButton>

namespace cnc::gui {

class JogButton : public QPushButton {
  Q_OBJECT

 public:
  explicit JogButton(const QString& text, QWidget* parent = nullptr);

 signals:
  void held();
  void let_go();

 protected:
  bool event(QEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;

 private:
  bool touch(const QEvent& event);
  void press();
  void release();
};

}  // namespace cnc::gui
