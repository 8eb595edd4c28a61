// Reads one stream of the server so that its consumer can wait for the next response, for the end,
// for too long a silence, or for being told to stop, whichever comes first.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <grpcpp/grpcpp.h>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

namespace cnc::api {

/// What happens to a response that the consumer has not taken when the next one could be read.
enum class Unread : std::uint8_t {
  replace,  ///< a slow consumer gets the newest only (status)
  wait,     ///< nothing is read until it has been taken, so the server's buffer holds it (messages)
};

template <typename Response>
class StreamReader final : public grpc::ClientReadReactor<Response> {
 public:
  /// `start(context, reactor)` makes the call through the generated stub.
  template <typename Start>
  StreamReader(Unread unread, Start start) : unread_(unread) {
    start(&context_, this);
    // Reads that next() starts come from outside gRPC's callbacks; the hold keeps the call alive.
    this->AddHold();
    this->StartRead(&incoming_);
    this->StartCall();
  }

  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;
  ~StreamReader() { end(); }

  /// The next response; nothing when the stream has ended, when `stop` was requested or when the
  /// server was silent for longer than `silence` (no limit if not given).
  [[nodiscard]] std::optional<Response> next(
      std::stop_token stop, std::optional<std::chrono::milliseconds> silence = std::nullopt) {
    std::unique_lock lock(mutex_);
    const auto ready = [this] { return response_.has_value() || status_.has_value(); };
    if (silence) {
      changed_.wait_for(lock, std::move(stop), *silence, ready);
    } else {
      changed_.wait(lock, std::move(stop), ready);
    }
    auto taken = std::exchange(response_, std::nullopt);
    if (taken && !is_reading_ && is_held_) start_read();
    return taken;
  }

  /// The server's last word, if the stream has ended.
  [[nodiscard]] std::optional<grpc::Status> status() {
    const std::lock_guard lock(mutex_);
    return status_;
  }

  /// Cancels the stream, if it has not ended, and waits until gRPC has let go of this object.
  void end() {
    context_.TryCancel();
    std::unique_lock lock(mutex_);
    if (!is_reading_) release();
    changed_.wait(lock, [this] { return status_.has_value(); });
  }

 private:
  void OnReadDone(bool ok) override {
    const std::lock_guard lock(mutex_);
    is_reading_ = false;
    if (!ok) {
      release();
      return;
    }
    response_ = std::move(incoming_);
    changed_.notify_all();
    if (unread_ == Unread::replace) start_read();
  }

  void OnDone(const grpc::Status& status) override {
    // Notified under the lock: the consumer may destroy this object as soon as it is free.
    const std::lock_guard lock(mutex_);
    status_ = status;
    changed_.notify_all();
  }

  void start_read() {
    is_reading_ = true;
    this->StartRead(&incoming_);
  }

  /// No more reads will be started; once.
  void release() {
    if (std::exchange(is_held_, false)) this->RemoveHold();
  }

  const Unread unread_;
  grpc::ClientContext context_;
  Response incoming_;  // gRPC's while is_reading_

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Response> response_;
  std::optional<grpc::Status> status_;
  bool is_reading_ = true;
  bool is_held_ = true;
};

}  // namespace cnc::api
