// Jogging with the keyboard (MAN-1): arrows move X and Y, PgUp and PgDn move Z; alone at 10 %, with
// Ctrl at 50 %, with Shift at 100 % of the axis' speed.
//
// Watches one window. Keys jog only while that window is active and no text editor has the focus;
// every end of that releases all keys.
#pragma once

#include <QKeyEvent>
#include <QWidget>
#include <span>

#include "api/axis.h"
#include "gui/jog_lease.h"

namespace cnc::gui {

struct JogKey {
  Qt::Key key;
  api::Axis axis;
  double direction;  ///< 1 or -1
  const char* name;  ///< as on the key cap
};

/// All keys that jog: for the event filter, the hints on the buttons, and the tests.
[[nodiscard]] std::span<const JogKey> jog_key_table();

/// 0.1, 0.5 with Ctrl, 1 with Shift.
[[nodiscard]] double jog_rate(Qt::KeyboardModifiers modifiers);

class JogKeys : public QObject {
  Q_OBJECT

 public:
  /// Both have to outlive this object.
  JogKeys(QWidget& window, JogLease& lease);

  bool eventFilter(QObject* watched, QEvent* event) override;

 signals:
  /// Whether the arrow keys jog now, for a lamp.
  void armed_changed(bool armed);

 private:
  bool press(const QKeyEvent& event);
  bool release(const QKeyEvent& event);
  void update_armed();

  QWidget& window_;
  JogLease& lease_;
  bool armed_ = false;
};

}  // namespace cnc::gui
