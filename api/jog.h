// Continuous manual motion while a key is held.
//
// The machine moves only as long as somebody says so: every set() is a lease of some hundred
// milliseconds, and when the lease runs out the server stops the machine. This library never renews
// a lease by itself, on purpose: a hung screen must not keep a machine moving. Call set() from the
// thread that knows whether the key is still down, every renewal_interval(), for example from a
// timer of the screen's event loop, or let while_held() do it for a program without an event loop.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include "api/axis.h"
#include "api/error.h"

namespace cnc::api {

struct JogVelocity {
  Axis axis = Axis::X;
  double rate = 0.0;  ///< -1 … 1, part of the axis' maximum velocity; the sign is the direction
};
using JogVelocities = std::vector<JogVelocity>;

struct JogOptions {
  std::chrono::milliseconds lease{250};  ///< 50 … 1000
};

/// The destructor stops the machine and does not wait for the standstill. Not for use by two
/// threads at once.
class JogSession {
 public:
  class Impl;

  explicit JogSession(std::unique_ptr<Impl> impl);
  JogSession(JogSession&&) noexcept;
  JogSession& operator=(JogSession&&) noexcept;
  ~JogSession();

  /// Wanted velocities from now on; axes not named stop; none at all stops the machine and keeps
  /// the session. Never waits for the server: while an earlier request is on its way, only the
  /// newest is kept. A refusal (not homed, soft limit, estop …) ends the session and is what the
  /// next call answers.
  [[nodiscard]] Result<void> set(const JogVelocities& velocities);

  /// How often set() has to be called while the key is held: a third of the lease.
  [[nodiscard]] std::chrono::milliseconds renewal_interval() const;

  /// What the server answered last: whether the machine moves.
  [[nodiscard]] bool moving() const;

  /// Moves while `is_held()` answers true, which is asked on the calling thread every
  /// renewal_interval(): if it hangs, the lease runs out. Then stops, like finish().
  [[nodiscard]] Result<void> while_held(const JogVelocities& velocities,
                                        const std::function<bool()>& is_held);

  /// Stops the machine and waits for the server's last word on this session (at most the client's
  /// call time-out). The session is over then.
  [[nodiscard]] Result<void> finish();

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace cnc::api
