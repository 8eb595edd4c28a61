// What the tests of the screen share: the application (off the screen), statuses, and waiting for a
// condition with a bound.
#pragma once

#include <QApplication>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWidget>
#include <chrono>
#include <functional>
#include <initializer_list>
#include <vector>

#include "api/status.h"
#include "gui/machine_facts.h"
#include "gui/request.h"

namespace cnc::gui::test {

/// The one QApplication of this program; there is no display behind it unless QT_QPA_PLATFORM says
/// so.
QApplication& application();

/// Handles events until `is_true` answers true; false if that did not happen in `bound`.
[[nodiscard]] bool wait_until(const std::function<bool()>& is_true,
                              std::chrono::milliseconds bound = std::chrono::seconds(5));

/// Shown and active, as the keyboard needs it.
void show_active(QWidget& window);

/// A status in which exactly these commands are allowed; the others say why not.
[[nodiscard]] api::MachineStatus status_with(api::MachineState state,
                                             std::initializer_list<api::Command> allowed);
inline constexpr const char* kRefusal = "The machine has to be homed first.";

[[nodiscard]] MachineFacts facts_with(std::initializer_list<api::Axis> axes);

/// A key event as the platform delivers it: to the window, from where it finds the focus.
void send_key(QWidget& window, QEvent::Type type, int key,
              Qt::KeyboardModifiers modifiers = Qt::NoModifier, bool auto_repeat = false);
void send_mouse(QWidget& widget, QEvent::Type type, QPoint position);

/// The child with this object name; the test fails if there is none.
template <typename Widget>
[[nodiscard]] Widget& child(QWidget& parent, const char* name) {
  auto* const found = parent.findChild<Widget*>(QString::fromLatin1(name));
  if (found == nullptr) throw std::runtime_error(std::string("no widget ") + name);
  return *found;
}

/// The requests of this kind among those that were emitted.
template <typename Kind>
[[nodiscard]] std::vector<Kind> only(const std::vector<Request>& requests) {
  std::vector<Kind> kinds;
  for (const Request& request : requests) {
    if (const auto* const kind = std::get_if<Kind>(&request)) kinds.push_back(*kind);
  }
  return kinds;
}

}  // namespace cnc::gui::test
