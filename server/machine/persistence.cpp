#include "server/machine/persistence.h"

#include <utility>

namespace cnc::server {

ParameterSaver::ParameterSaver(std::filesystem::path path, MessageLog& log)
    : path_(std::move(path)), log_(log), thread_([this] { work(); }) {}

ParameterSaver::~ParameterSaver() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ParameterSaver::save(const config::ParameterStore& parameters) {
  if (path_.empty()) return;
  {
    const std::scoped_lock lock(mutex_);
    waiting_ = parameters;
  }
  changed_.notify_all();
}

void ParameterSaver::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !waiting_ && !writing_; });
}

void ParameterSaver::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return waiting_ || ending_; });
    if (!waiting_) return;
    const config::ParameterStore parameters = std::move(*waiting_);
    waiting_.reset();
    writing_ = true;
    lock.unlock();
    if (auto saved = parameters.save(path_); !saved) log_.add(saved.error());
    lock.lock();
    writing_ = false;
    changed_.notify_all();
  }
}

}  // namespace cnc::server
