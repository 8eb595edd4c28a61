#include "tests/gui/support.h"

#include <QElapsedTimer>
#include <QWindow>
#include <algorithm>

namespace cnc::gui::test {

QApplication& application() {
  static int argc = 1;
  static char name[] = "cnc_gui_test";
  static char* argv[] = {name, nullptr};
  static QApplication* const instance = [] {
    if (!qEnvironmentVariableIsSet("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
    return new QApplication(argc, argv);  // lives until the program ends: Qt wants it last
  }();
  return *instance;
}

bool wait_until(const std::function<bool()>& is_true, std::chrono::milliseconds bound) {
  QElapsedTimer timer;
  timer.start();
  constexpr int kSlice = 10;  // ms; returns earlier when an event comes
  while (!is_true()) {
    if (timer.hasExpired(bound.count())) return false;
    QCoreApplication::processEvents(QEventLoop::AllEvents | QEventLoop::WaitForMoreEvents, kSlice);
  }
  return true;
}

void show_active(QWidget& window) {
  window.show();
  window.activateWindow();
  window.setFocus();
  if (!wait_until([&] { return window.isActiveWindow(); })) {
    throw std::runtime_error("the window did not become active");
  }
}

api::MachineStatus status_with(api::MachineState state,
                               std::initializer_list<api::Command> allowed) {
  api::MachineStatus status;
  status.state = state;
  for (std::size_t index = 0; index < api::kCommandCount; ++index) {
    const bool is_allowed =
        std::ranges::find(allowed, static_cast<api::Command>(index)) != allowed.end();
    status.commands.at(index) = {is_allowed, is_allowed ? "" : kRefusal};
  }
  return status;
}

MachineFacts facts_with(std::initializer_list<api::Axis> axes) {
  MachineFacts facts;
  facts.version.controller = "virtual board";
  for (const api::Axis axis : axes) facts.machine.axes.push_back({.axis = axis});
  return facts;
}

void send_key(QWidget& window, QEvent::Type type, int key, Qt::KeyboardModifiers modifiers,
              bool auto_repeat) {
  QKeyEvent event(type, key, modifiers, QString(), auto_repeat);
  QCoreApplication::sendEvent(window.windowHandle(), &event);
}

void send_mouse(QWidget& widget, QEvent::Type type, QPoint position) {
  const bool is_release = type == QEvent::MouseButtonRelease;
  const Qt::MouseButton button = type == QEvent::MouseMove ? Qt::NoButton : Qt::LeftButton;
  QMouseEvent event(type, position, widget.mapToGlobal(position), button,
                    is_release ? Qt::NoButton : Qt::LeftButton, Qt::NoModifier);
  QCoreApplication::sendEvent(&widget, &event);
}

}  // namespace cnc::gui::test
