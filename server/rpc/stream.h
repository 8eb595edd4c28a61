// A server stream that looks for something new at a steady pace, on the fanout's thread.
//
// At most one write is under way; a client that does not read is simply asked again later, so it
// costs neither the machine nor another client anything.
#pragma once

#include <atomic>
#include <functional>
#include <grpcpp/grpcpp.h>
#include <memory>
#include <utility>

#include "server/daemon/task_thread.h"

namespace cnc::server::rpc {

/// `fill` is called on the fanout's thread when the client is ready for the next message; it
/// returns false when there is nothing new.
template <typename Message>
class PolledStream final : public grpc::ServerWriteReactor<Message>,
                           public std::enable_shared_from_this<PolledStream<Message>> {
 public:
  using Fill = std::function<bool(Message&)>;

  static grpc::ServerWriteReactor<Message>* start(TaskThread& fanout,
                                                  std::chrono::microseconds period, Fill fill) {
    auto stream = std::make_shared<PolledStream>(std::move(fill));
    stream->self_ = stream;
    fanout.every(period, [stream] { return stream->poll(); });
    return stream.get();
  }

  explicit PolledStream(Fill fill) : fill_(std::move(fill)) {}

  void OnWriteDone(bool ok) override {
    if (!ok) cancelled_.store(true, std::memory_order_release);
    writing_.store(false, std::memory_order_release);
  }
  void OnCancel() override { cancelled_.store(true, std::memory_order_release); }
  void OnDone() override { self_.reset(); }

 private:
  bool poll() {
    if (writing_.load(std::memory_order_acquire)) return true;
    if (cancelled_.load(std::memory_order_acquire)) {
      this->Finish(grpc::Status::CANCELLED);
      return false;
    }
    message_.Clear();
    if (!fill_(message_)) return true;
    writing_.store(true, std::memory_order_release);
    this->StartWrite(&message_);
    return true;
  }

  const Fill fill_;
  Message message_;
  std::atomic<bool> writing_{false};
  std::atomic<bool> cancelled_{false};
  std::shared_ptr<PolledStream> self_;  // gRPC holds the stream by pointer until OnDone
};

}  // namespace cnc::server::rpc
