#include "gui/command_button.h"

#include <QMouseEvent>
#include <QToolTip>

#include "gui/style.h"
#include "gui/text.h"

namespace cnc::gui {

CommandButton::CommandButton(const QString& text, QWidget* parent) : QPushButton(text, parent) {
  // Neither Space nor Enter may start a motion: keys take no focus.
  setFocusPolicy(Qt::NoFocus);
  setAutoDefault(false);
}

void CommandButton::show_availability(const api::CommandAvailability& availability) {
  if (isEnabled() != availability.allowed) setEnabled(availability.allowed);
  const QString reason = to_text(availability.reason);
  if (toolTip() != reason) setToolTip(reason);
}

void CommandButton::set_awaited(bool awaited) {
  set_look(*this, "awaited", awaited ? QStringLiteral("yes") : QStringLiteral("no"));
}

bool CommandButton::event(QEvent* event) {
  if (event->type() == QEvent::MouseButtonPress && !isEnabled() && !toolTip().isEmpty()) {
    const auto& press = static_cast<const QMouseEvent&>(*event);
    QToolTip::showText(press.globalPosition().toPoint(), toolTip(), this);
  }
  return QPushButton::event(event);
}

}  // namespace cnc::gui
