// One jog stream. At most one request is on its way; a newer one replaces one that still waits, so
// a slow network never piles up old wishes.
#pragma once

#include <chrono>
#include <condition_variable>
#include <grpcpp/grpcpp.h>
#include <memory>
#include <mutex>
#include <optional>

#include "api/jog.h"
#include "api/src/connection.h"

namespace cnc::api {

class JogSession::Impl final : public grpc::ClientBidiReactor<v1::JogRequest, v1::JogResponse> {
 public:
  Impl(std::shared_ptr<const Connection> connection, const JogOptions& options);
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() override;

  [[nodiscard]] Result<void> set(const JogVelocities& velocities);
  [[nodiscard]] Result<void> finish();
  [[nodiscard]] bool moving();
  [[nodiscard]] std::chrono::milliseconds renewal_interval() const { return options_.lease / 3; }
  /// Waits, at most `time`, for the end of the session.
  void wait_for_end(std::chrono::milliseconds time);

 private:
  using Clock = std::chrono::steady_clock;

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  // With the mutex held.
  void send(v1::JogRequest request);
  void write(v1::JogRequest request);
  void close_writes();
  void release();
  [[nodiscard]] bool server_is_silent() const;
  [[nodiscard]] Result<void> outcome() const;

  const std::shared_ptr<const Connection> connection_;
  const JogOptions options_;
  grpc::ClientContext context_;
  v1::JogRequest outgoing_;   // gRPC's while is_writing_
  v1::JogResponse incoming_;  // gRPC's until the stream ends

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<v1::JogRequest> waiting_;  // to be written when the one on its way is through
  std::optional<Clock::time_point> unanswered_since_;
  std::optional<grpc::Status> status_;  // set at the end
  bool is_writing_ = false;
  bool is_closing_ = false;  // finish() was called: close after the last request
  bool is_held_ = true;      // gRPC may still be given requests
  bool is_moving_ = false;
};

}  // namespace cnc::api
