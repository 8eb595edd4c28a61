#include "server/daemon/task_thread.h"

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <thread>
#include <utility>

#include "server/daemon/real_time.h"

namespace cnc::server {

namespace asio = boost::asio;

struct TaskThread::Impl {
  asio::io_context context{1};
  asio::executor_work_guard<asio::io_context::executor_type> keep_running =
      asio::make_work_guard(context);
  std::thread thread{[this] { context.run(); }};
};

namespace {

class Repeating : public std::enable_shared_from_this<Repeating> {
 public:
  Repeating(asio::io_context& context, std::chrono::microseconds period, std::function<bool()> task)
      : timer_(context), period_(period), task_(std::move(task)) {}

  void run() {
    if (!task_()) return;
    due_ = std::max(due_ + period_, std::chrono::steady_clock::now());
    timer_.expires_at(due_);
    timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
      if (!error) self->run();
    });
  }

 private:
  asio::steady_timer timer_;
  const std::chrono::microseconds period_;
  const std::function<bool()> task_;
  std::chrono::steady_clock::time_point due_ = std::chrono::steady_clock::now();
};

}  // namespace

TaskThread::TaskThread() : impl_(std::make_unique<Impl>()) {}

TaskThread::~TaskThread() { stop(); }

void TaskThread::post(std::function<void()> task) { asio::post(impl_->context, std::move(task)); }

void TaskThread::every(std::chrono::microseconds period, std::function<bool()> task) {
  auto repeating = std::make_shared<Repeating>(impl_->context, period, std::move(task));
  asio::post(impl_->context, [repeating] { repeating->run(); });
}

std::string TaskThread::request_priority(int priority) {
  return request_fifo(impl_->thread.native_handle(), priority);
}

void TaskThread::stop() {
  impl_->context.stop();
  if (impl_->thread.joinable()) impl_->thread.join();
}

}  // namespace cnc::server
