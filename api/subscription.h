// A stream of the server that keeps itself alive: it reconnects by itself, first after 0.1 s, then
// after ever longer waits up to 2 s, for as long as the handle lives. Each new connection checks
// the API version again, because the server may have been replaced meanwhile.
//
// Thread rules. Every subscription owns one thread, and all its callbacks run on that thread, never
// two at once, never before subscribe_…() was called and never after the handle's destructor has
// returned. A callback may call any function of Client. It must not destroy its own handle: that
// would wait for itself, and it must not throw. A slow callback delays only its own subscription.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "api/error.h"
#include "api/message.h"
#include "api/status.h"

namespace cnc::api {

/// Told once for every change of `connected` or of the kind of the reason, beginning with the
/// outcome of the first attempt; not for every further attempt that fails for the same reason.
struct ConnectionChange {
  bool connected = false;
  std::optional<Error> reason;  ///< why not connected: unavailable, incompatible, …
};

using OnStatus = std::function<void(const MachineStatus&)>;
using OnMessage = std::function<void(const Message&)>;
using OnConnectionChange = std::function<void(const ConnectionChange&)>;

struct StatusOptions {
  double max_rate = 20.0;  ///< statuses per second, 1 … 100
};

/// Ends its stream and waits for its thread when destroyed. Does not keep a Client alive and does
/// not need one: it may outlive the Client that made it.
class Subscription {
 public:
  class Impl;

  Subscription();  ///< holds nothing
  explicit Subscription(std::unique_ptr<Impl> impl);
  Subscription(Subscription&&) noexcept;
  Subscription& operator=(Subscription&&) noexcept;
  ~Subscription();

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace cnc::api
