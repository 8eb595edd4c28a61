#include "api/src/subscription.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "api/src/convert.h"
#include "api/src/local_error.h"
#include "api/src/stream_reader.h"

namespace cnc::api {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFirstWait{100};
constexpr milliseconds kLongestWait{2'000};

/// Tells the subscriber what is new for him.
class ConnectionReporter {
 public:
  explicit ConnectionReporter(OnConnectionChange callback) : callback_(std::move(callback)) {}

  void connected() { report({.connected = true, .reason = std::nullopt}); }
  void disconnected(Error reason) { report({.connected = false, .reason = std::move(reason)}); }

 private:
  void report(ConnectionChange now) {
    const bool is_new = !last_ || last_->connected != now.connected ||
                        (!now.connected && last_->reason->kind != now.reason->kind);
    last_ = std::move(now);
    if (is_new && callback_) callback_(*last_);
  }

  OnConnectionChange callback_;
  std::optional<ConnectionChange> last_;
};

void sleep_for(milliseconds time, const std::stop_token& stop) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any never;
  never.wait_for(lock, stop, time, [] { return false; });
}

/// The pause before the next attempt; shorter if the lost connection comes back meanwhile. gRPC
/// moves a new connection on only while somebody waits for it: if this thread merely slept, each
/// handshake would time out.
void wait(grpc::Channel& channel, milliseconds time, const std::stop_token& stop) {
  if (channel.GetState(true) == GRPC_CHANNEL_READY) return sleep_for(time, stop);
  constexpr milliseconds kSlice{50};  // how late a stop request may be noticed
  for (milliseconds left = time; left > milliseconds(0) && !stop.stop_requested(); left -= kSlice)
    if (channel.WaitForConnected(std::chrono::system_clock::now() + std::min(left, kSlice))) return;
}

/// Runs one stream from connecting to its end and answers why it ended. It calls `connected` as
/// soon as the server has shown that it serves this stream.
using StreamOnce =
    std::function<Error(const std::stop_token& stop, const std::function<void()>& connected)>;

void keep_connected(const std::stop_token& stop, grpc::Channel& channel, const StreamOnce& stream,
                    ConnectionReporter& reporter) {
  milliseconds pause = kFirstWait;
  const auto connected = [&] {
    pause = kFirstWait;
    reporter.connected();
  };
  while (true) {
    Error reason = stream(stop, connected);
    if (stop.stop_requested()) return;
    reporter.disconnected(std::move(reason));
    wait(channel, pause, stop);
    if (stop.stop_requested()) return;
    pause = std::min(2 * pause, kLongestWait);
  }
}

Subscription subscribe(std::shared_ptr<grpc::Channel> channel, StreamOnce stream,
                       OnConnectionChange on_connection_change) {
  return Subscription(std::make_unique<Subscription::Impl>(
      [channel = std::move(channel), stream = std::move(stream),
       reporter = ConnectionReporter(std::move(on_connection_change))](
          std::stop_token stop) mutable { keep_connected(stop, *channel, stream, reporter); }));
}

/// Why a stream ended whose reader answers nothing more: its status, or the server fell silent.
template <typename Response>
Error reason_of_end(const Connection& connection, StreamReader<Response>& reader) {
  const auto status = reader.status();
  if (!status) {
    return make_local_error(ErrorKind::unavailable,
                            "The server at " + connection.address + " has fallen silent.");
  }
  if (!status->ok()) return connection.explain(*status, false);
  return make_local_error(ErrorKind::unavailable,
                          "The server at " + connection.address + " ended the stream.");
}

/// Hands on the newest status for as long as they come.
class StatusStream {
 public:
  StatusStream(std::shared_ptr<const Connection> connection, const StatusOptions& options,
               OnStatus on_status)
      : connection_(std::move(connection)), on_status_(std::move(on_status)) {
    request_.set_max_rate(options.max_rate);
  }

  Error operator()(const std::stop_token& stop, const std::function<void()>& connected) const {
    if (const auto version = connection_->check_version(kSilenceLimit, stop); !version) {
      return version.error();
    }
    StreamReader<v1::MachineStatus> reader(Unread::replace, [this](auto* context, auto* reactor) {
      connection_->status->async()->Watch(context, &request_, reactor);
    });
    while (const auto status = reader.next(stop, kSilenceLimit)) {
      connected();
      if (on_status_) on_status_(from_wire(*status));
      if (stop.stop_requested()) break;
    }
    return reason_of_end(*connection_, reader);
  }

 private:
  std::shared_ptr<const Connection> connection_;
  v1::WatchStatusRequest request_;
  OnStatus on_status_;
};

/// Hands on messages in order, each once. Remembers the last one, to go on behind it after a
/// reconnection.
class MessageStream {
 public:
  MessageStream(std::shared_ptr<const Connection> connection, std::uint64_t after,
                OnMessage on_message)
      : connection_(std::move(connection)), after_(after), on_message_(std::move(on_message)) {}

  Error operator()(const std::stop_token& stop, const std::function<void()>& connected) {
    if (const auto version = connection_->check_version(kSilenceLimit, stop); !version) {
      return version.error();
    }
    const auto restarted = counts_anew(stop);
    if (!restarted) return restarted.error();
    if (*restarted) after_ = 0;

    v1::WatchMessagesRequest request;
    request.set_after(after_);
    StreamReader<v1::Message> reader(Unread::wait, [&](auto* context, auto* reactor) {
      connection_->messages->async()->Watch(context, &request, reactor);
    });
    connected();
    while (const auto wire = reader.next(stop)) {
      after_ = wire->sequence();
      last_time_unix_ms_ = wire->time_unix_ms();
      if (on_message_) on_message_(from_wire(*wire));
      if (stop.stop_requested()) break;
    }
    return reason_of_end(*connection_, reader);
  }

 private:
  /// Whether the server's messages are no longer those that we know: it has none with our last
  /// number, or another one, told by its time.
  Result<bool> counts_anew(const std::stop_token& stop) const {
    if (after_ == 0) return false;
    v1::ListMessagesRequest request;
    request.set_after(after_ - 1);
    const auto response = connection_->call(*connection_->messages, &v1::Messages::Stub::List,
                                            request, kSilenceLimit, stop);
    if (!response) return std::unexpected(response.error());
    if (response->messages().empty()) return true;
    const v1::Message& oldest = response->messages(0);
    return oldest.sequence() == after_ && last_time_unix_ms_ &&
           oldest.time_unix_ms() != *last_time_unix_ms_;
  }

  std::shared_ptr<const Connection> connection_;
  std::uint64_t after_;
  std::optional<std::int64_t> last_time_unix_ms_;
  OnMessage on_message_;
};

}  // namespace

Subscription::Subscription() = default;
Subscription::Subscription(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Subscription::Subscription(Subscription&&) noexcept = default;
Subscription& Subscription::operator=(Subscription&&) noexcept = default;
Subscription::~Subscription() = default;

Subscription make_status_subscription(std::shared_ptr<const Connection> connection,
                                      const StatusOptions& options, OnStatus on_status,
                                      OnConnectionChange on_connection_change) {
  auto channel = connection->channel;
  return subscribe(std::move(channel),
                   StatusStream(std::move(connection), options, std::move(on_status)),
                   std::move(on_connection_change));
}

Subscription make_message_subscription(std::shared_ptr<const Connection> connection,
                                       std::uint64_t after, OnMessage on_message,
                                       OnConnectionChange on_connection_change) {
  auto channel = connection->channel;
  return subscribe(std::move(channel),
                   MessageStream(std::move(connection), after, std::move(on_message)),
                   std::move(on_connection_change));
}

}  // namespace cnc::api
