#include "gui/jog_keys.h"

#include <QApplication>
#include <algorithm>
#include <array>

namespace cnc::gui {
namespace {

using api::Axis;

constexpr std::array kJogKeys{
    JogKey{Qt::Key_Left, Axis::X, -1.0, "←"},        JogKey{Qt::Key_Right, Axis::X, 1.0, "→"},
    JogKey{Qt::Key_Down, Axis::Y, -1.0, "↓"},        JogKey{Qt::Key_Up, Axis::Y, 1.0, "↑"},
    JogKey{Qt::Key_PageDown, Axis::Z, -1.0, "PgDn"}, JogKey{Qt::Key_PageUp, Axis::Z, 1.0, "PgUp"},
};

constexpr std::array kModifierKeys{int{Qt::Key_Shift}, int{Qt::Key_Control}};

// Modifiers are ignored here: a key that was pressed with Shift may be released without.
const JogKey* find_key(const QKeyEvent& event) {
  const auto* const found = std::ranges::find(
      kJogKeys, event.key(), [](const JogKey& row) { return static_cast<int>(row.key); });
  return found == kJogKeys.end() ? nullptr : found;
}

bool takes_text(const QWidget* widget) {
  return widget != nullptr && widget->testAttribute(Qt::WA_InputMethodEnabled);
}

bool ends_jogging(QEvent::Type type) {
  return type == QEvent::WindowDeactivate || type == QEvent::WindowBlocked ||
         type == QEvent::Hide || type == QEvent::FocusOut;
}

}  // namespace

std::span<const JogKey> jog_key_table() { return kJogKeys; }

double jog_rate(Qt::KeyboardModifiers modifiers) {
  if (modifiers.testFlag(Qt::ShiftModifier)) return 1.0;
  if (modifiers.testFlag(Qt::ControlModifier)) return 0.5;
  return 0.1;
}

JogKeys::JogKeys(QWidget& window, JogLease& lease)
    : QObject(&window), window_(window), lease_(lease) {
  window_.installEventFilter(this);
  connect(qApp, &QGuiApplication::applicationStateChanged, this, [this] {
    lease_.release_all();
    update_armed();
  });
  connect(qApp, &QApplication::focusChanged, this, [this] {
    lease_.release_all();
    update_armed();
  });
}

bool JogKeys::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::KeyPress) return press(static_cast<const QKeyEvent&>(*event));
  if (event->type() == QEvent::KeyRelease) return release(static_cast<const QKeyEvent&>(*event));
  if (ends_jogging(event->type())) lease_.release_all();
  if (event->type() == QEvent::WindowActivate || ends_jogging(event->type())) update_armed();
  return QObject::eventFilter(watched, event);
}

bool JogKeys::press(const QKeyEvent& event) {
  const JogKey* const row = find_key(event);
  if (row == nullptr || !armed_) return false;
  if (!event.isAutoRepeat()) {
    lease_.hold(row->key, {row->axis, row->direction * jog_rate(event.modifiers())});
  }
  return true;
}

bool JogKeys::release(const QKeyEvent& event) {
  if (std::ranges::find(kModifierKeys, event.key()) != kModifierKeys.end()) {
    for (const JogKey& row : kJogKeys) lease_.slow_down(row.key, jog_rate(event.modifiers()));
  }
  const JogKey* const row = find_key(event);
  if (row == nullptr) return false;
  if (!event.isAutoRepeat()) lease_.release(row->key);
  return true;
}

void JogKeys::update_armed() {
  const bool armed = window_.isActiveWindow() && !takes_text(QApplication::focusWidget());
  if (armed == armed_) return;
  armed_ = armed;
  emit armed_changed(armed_);
}

}  // namespace cnc::gui
