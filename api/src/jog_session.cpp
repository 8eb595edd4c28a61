#include "api/src/jog_session.h"

#include <utility>

#include "api/src/convert.h"
#include "api/src/local_error.h"

namespace cnc::api {
namespace {

v1::JogRequest make_request(const JogVelocities& velocities, std::chrono::milliseconds lease) {
  v1::JogRequest request;
  request.set_lease(std::chrono::duration<double>(lease).count());
  for (const JogVelocity& velocity : velocities) {
    v1::JogVelocity& wire = *request.add_velocities();
    wire.set_axis(to_wire(velocity.axis));
    wire.set_rate(velocity.rate);
  }
  return request;
}

}  // namespace

JogSession::Impl::Impl(std::shared_ptr<const Connection> connection, const JogOptions& options)
    : connection_(std::move(connection)), options_(options) {
  connection_->jog->async()->Jog(&context_, this);
  AddHold();  // requests come from outside gRPC's callbacks
  StartRead(&incoming_);
  StartCall();
}

JogSession::Impl::~Impl() {
  context_.TryCancel();  // the end of the stream stops the machine
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return status_.has_value(); });
}

Result<void> JogSession::Impl::set(const JogVelocities& velocities) {
  const std::lock_guard lock(mutex_);
  if (status_) return outcome();
  if (server_is_silent()) {
    context_.TryCancel();
    return std::unexpected(
        make_local_error(ErrorKind::unavailable,
                         "The server at " + connection_->address +
                             " has fallen silent; it stops the machine when the lease ends."));
  }
  send(make_request(velocities, options_.lease));
  return {};
}

Result<void> JogSession::Impl::finish() {
  std::unique_lock lock(mutex_);
  if (!is_closing_ && is_held_) {
    send(make_request({}, options_.lease));
    is_closing_ = true;
  }
  const auto has_ended = [this] { return status_.has_value(); };
  if (!changed_.wait_for(lock, connection_->options.call_timeout, has_ended)) {
    context_.TryCancel();
    return std::unexpected(make_local_error(
        ErrorKind::timed_out, "The server at " + connection_->address +
                                  " did not confirm the stop; the lease ends the motion."));
  }
  if (status_->ok()) return {};
  return outcome();
}

bool JogSession::Impl::moving() {
  const std::lock_guard lock(mutex_);
  return is_moving_;
}

void JogSession::Impl::wait_for_end(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, time, [this] { return status_.has_value(); });
}

void JogSession::Impl::send(v1::JogRequest request) {
  if (!is_held_ || is_closing_) return;  // the stream is ending; its status follows
  if (!unanswered_since_) unanswered_since_ = Clock::now();
  if (is_writing_) {
    waiting_ = std::move(request);
  } else {
    write(std::move(request));
  }
}

void JogSession::Impl::write(v1::JogRequest request) {
  outgoing_ = std::move(request);
  is_writing_ = true;
  StartWrite(&outgoing_);
}

void JogSession::Impl::OnWriteDone(bool ok) {
  const std::lock_guard lock(mutex_);
  is_writing_ = false;
  if (!ok || !is_held_) return;  // the stream is broken: OnReadDone and OnDone follow
  if (waiting_) {
    write(*std::exchange(waiting_, std::nullopt));
  } else if (is_closing_) {
    close_writes();
  }
}

void JogSession::Impl::close_writes() {
  StartWritesDone();
  release();
}

void JogSession::Impl::OnReadDone(bool ok) {
  const std::lock_guard lock(mutex_);
  if (!ok) {
    release();
    return;
  }
  is_moving_ = incoming_.moving();
  unanswered_since_.reset();
  StartRead(&incoming_);
}

void JogSession::Impl::OnDone(const grpc::Status& status) {
  // Notified under the lock: the session may be destroyed as soon as it is free.
  const std::lock_guard lock(mutex_);
  status_ = status;
  is_moving_ = false;
  changed_.notify_all();
}

void JogSession::Impl::release() {
  if (std::exchange(is_held_, false)) RemoveHold();
}

bool JogSession::Impl::server_is_silent() const {
  return unanswered_since_ && Clock::now() - *unanswered_since_ > kSilenceLimit;
}

Result<void> JogSession::Impl::outcome() const {
  if (!status_->ok()) return std::unexpected(connection_->explain(*status_, false));
  return std::unexpected(make_local_error(ErrorKind::failed, "The jog session has ended."));
}

JogSession::JogSession(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JogSession::JogSession(JogSession&&) noexcept = default;
JogSession& JogSession::operator=(JogSession&&) noexcept = default;
JogSession::~JogSession() = default;

Result<void> JogSession::set(const JogVelocities& velocities) { return impl_->set(velocities); }

std::chrono::milliseconds JogSession::renewal_interval() const { return impl_->renewal_interval(); }

bool JogSession::moving() const { return impl_->moving(); }

Result<void> JogSession::while_held(const JogVelocities& velocities,
                                    const std::function<bool()>& is_held) {
  while (is_held()) {
    if (auto sent = impl_->set(velocities); !sent) return sent;
    impl_->wait_for_end(impl_->renewal_interval());
  }
  return impl_->finish();
}

Result<void> JogSession::finish() { return impl_->finish(); }

}  // namespace cnc::api
