// The two subscriptions of the API, made of one loop that keeps a stream connected.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <thread>

#include "api/src/connection.h"
#include "api/subscription.h"

namespace cnc::api {

class Subscription::Impl {
 public:
  explicit Impl(std::function<void(std::stop_token)> body) : thread_(std::move(body)) {}

 private:
  std::jthread thread_;  // its destructor asks it to stop and waits
};

[[nodiscard]] Subscription make_status_subscription(std::shared_ptr<const Connection> connection,
                                                    const StatusOptions& options,
                                                    OnStatus on_status,
                                                    OnConnectionChange on_connection_change);

[[nodiscard]] Subscription make_message_subscription(std::shared_ptr<const Connection> connection,
                                                     std::uint64_t after, OnMessage on_message,
                                                     OnConnectionChange on_connection_change);

}  // namespace cnc::api
