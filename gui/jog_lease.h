// Which jog keys and buttons are physically down, and the renewals that follow from it.
//
// The server moves the machine only for a lease of a fraction of a second. As long as an input is
// held, this object says so again and again, from the event loop of the screen on purpose: a screen
// that hangs stops the machine. After a hang longer than the lease the inputs count as released,
// because a release may still wait in the event queue; the operator presses again.
#pragma once

#include <QMetaType>
#include <QObject>
#include <QTimer>
#include <QWidget>
#include <chrono>
#include <functional>
#include <map>
#include <variant>

#include "api/jog.h"

namespace cnc::gui {

/// What is held down: a key of the keyboard or a button on the screen.
using JogInput = std::variant<Qt::Key, const QWidget*>;

class JogLease : public QObject {
  Q_OBJECT

 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  /// A machine that lost its screen moves on for this long.
  static constexpr std::chrono::milliseconds kLease{150};
  static constexpr std::chrono::milliseconds kRenewal{50};

  explicit JogLease(QObject* parent = nullptr, Clock clock = std::chrono::steady_clock::now);

  /// The input went down and asks for `velocity`. Ignored while jogging is not allowed.
  void hold(const JogInput& input, api::JogVelocity velocity);
  /// Never faster than `rate` from now on, until the input is pressed again: a modifier key that
  /// changes under a held key may slow the machine, never speed it up.
  void slow_down(const JogInput& input, double rate);
  void release(const JogInput& input);
  /// For everything that makes it doubtful that the operator still means it: focus lost, window
  /// deactivated, dialog opened, state changed, server lost.
  void release_all();

  /// Taking the permission away releases everything.
  void set_allowed(bool allowed);
  [[nodiscard]] bool is_holding() const { return !held_.empty(); }

 signals:
  /// Wanted velocities, when they change and every kRenewal. Opposite inputs cancel each other.
  void renewed(const cnc::api::JogVelocities& velocities);
  /// Nothing is held any more.
  void ended();

 private:
  void renew();
  void renew_or_end();

  Clock clock_;
  QTimer timer_;
  std::map<JogInput, api::JogVelocity> held_;
  std::chrono::steady_clock::time_point last_renewal_;
  bool allowed_ = false;
};

}  // namespace cnc::gui
