#include "gui/machine_keys.h"

#include <QApplication>
#include <QKeyEvent>
#include <QWindow>
#include <algorithm>
#include <array>

namespace cnc::gui {
namespace {

struct MachineKey {
  Qt::Key key;
  Request (*request)();
};
constexpr std::array kKeys{
    MachineKey{Qt::Key_F1, [] { return Request{Reset{}}; }},
    MachineKey{Qt::Key_Escape, [] { return Request{Pause{}}; }},
};

}  // namespace

MachineKeys::MachineKeys(QObject* parent) : QObject(parent) { qApp->installEventFilter(this); }

bool MachineKeys::eventFilter(QObject* watched, QEvent* event) {
  // Once per key press: it comes to the window of the platform first, then to widgets.
  if (event->type() != QEvent::KeyPress || qobject_cast<QWindow*>(watched) == nullptr) return false;
  const auto& press = static_cast<const QKeyEvent&>(*event);
  const auto* const found = std::ranges::find(
      kKeys, press.key(), [](const MachineKey& row) { return static_cast<int>(row.key); });
  if (found != kKeys.end() && !press.isAutoRepeat()) emit requested(found->request());
  return false;
}

}  // namespace cnc::gui
