#include "server/machine/persistence.h"

#include <utility>

#include "config/atomic_file.h"

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

ParameterSaver::Ticket ParameterSaver::save(const config::ParameterStore& parameters) {
  if (path_.empty()) return 0;
  std::string text = parameters.to_text();
  const std::scoped_lock lock(mutex_);
  if (text == newest_text_) return newest_;
  newest_text_ = std::move(text);
  changed_.notify_all();
  return ++newest_;
}

std::optional<Result<void>> ParameterSaver::outcome(Ticket ticket) const {
  const std::scoped_lock lock(mutex_);
  if (done_ < ticket) return std::nullopt;
  return result_;
}

void ParameterSaver::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return done_ == newest_; });
}

void ParameterSaver::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return done_ != newest_ || ending_; });
    if (done_ == newest_) return;
    const std::string text = newest_text_;
    const Ticket ticket = newest_;
    lock.unlock();
    Result<void> written = config::write_file_atomically(path_, text);
    if (!written) log_.add(written.error());
    lock.lock();
    if (!written && newest_ == ticket) newest_text_.clear();
    done_ = ticket;
    result_ = std::move(written);
    changed_.notify_all();
  }
}

}  // namespace cnc::server
