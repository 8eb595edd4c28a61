#include <deque>

#include "cnc/v1/messages.grpc.pb.h"
#include "server/rpc/host.h"
#include "server/rpc/stream.h"

namespace cnc::server::rpc {
namespace {

constexpr std::chrono::milliseconds kPeriod{50};

/// Hands out what came after the last message that was handed out, one by one.
class MessageCursor {
 public:
  MessageCursor(const MessageLog& log, std::uint64_t after) : log_(&log), last_(after) {}

  bool operator()(v1::Message& message) {
    if (waiting_.empty() && log_->newest() > last_)
      for (LogMessage& next : log_->after(last_)) waiting_.push_back(std::move(next));
    if (waiting_.empty()) return false;
    last_ = waiting_.front().sequence;
    message = to_proto(waiting_.front());
    waiting_.pop_front();
    return true;
  }

 private:
  const MessageLog* log_;
  std::uint64_t last_;
  std::deque<LogMessage> waiting_;
};

class MessagesService final : public v1::Messages::CallbackService {
 public:
  explicit MessagesService(Host& host) : host_(host) {}

  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext*,
                                 const v1::ListMessagesRequest* request,
                                 v1::ListMessagesResponse* response) override {
    for (const LogMessage& message : host_.log.after(request->after(), request->limit()))
      *response->add_messages() = to_proto(message);
    return answer(grpc::Status::OK);
  }

  grpc::ServerWriteReactor<v1::Message>* Watch(grpc::CallbackServerContext*,
                                               const v1::WatchMessagesRequest* request) override {
    return PolledStream<v1::Message>::start(host_.fanout, kPeriod,
                                            MessageCursor(host_.log, request->after()));
  }

 private:
  Host& host_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_messages_service(Host& host) {
  return std::make_unique<MessagesService>(host);
}

}  // namespace cnc::server::rpc
