#include "gui/jog_button.h"

#include <QMouseEvent>
#include <QTouchEvent>

namespace cnc::gui {
namespace {

bool ends_holding(QEvent::Type type) {
  return type == QEvent::Hide || type == QEvent::EnabledChange ||
         type == QEvent::WindowDeactivate || type == QEvent::WindowBlocked;
}

}  // namespace

JogButton::JogButton(const QString& text, QWidget* parent) : QPushButton(text, parent) {
  setFocusPolicy(Qt::NoFocus);
  setAutoDefault(false);
  // Touch is handled as touch: the mouse events that would otherwise be made of it come late and
  // without a cancellation.
  setAttribute(Qt::WA_AcceptTouchEvents);
}

bool JogButton::event(QEvent* event) {
  if (ends_holding(event->type())) release();
  if (isEnabled() && touch(*event)) return true;
  return QPushButton::event(event);
}

bool JogButton::touch(const QEvent& event) {
  switch (event.type()) {
    case QEvent::TouchBegin:
      press();
      return true;
    case QEvent::TouchUpdate: {
      const auto& points = static_cast<const QTouchEvent&>(event).points();
      if (points.isEmpty() || !rect().contains(points.first().position().toPoint())) release();
      return true;
    }
    case QEvent::TouchEnd:
    case QEvent::TouchCancel:
      release();
      return true;
    default:  // the other 200 kinds of event are QPushButton's
      return false;
  }
}

void JogButton::mousePressEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton) press();
}

void JogButton::mouseMoveEvent(QMouseEvent* event) {
  if (!rect().contains(event->position().toPoint())) release();
}

void JogButton::mouseReleaseEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton) release();
}

void JogButton::press() {
  if (isDown()) return;
  setDown(true);
  emit held();
}

void JogButton::release() {
  if (!isDown()) return;
  setDown(false);
  emit let_go();
}

}  // namespace cnc::gui
