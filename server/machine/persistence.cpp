#include "server/machine/persistence.h"

#include <utility>

#include "config/atomic_file.h"

namespace cnc::server {

StateSaver::StateSaver(StateFiles files, MessageLog& log)
    : files_(std::move(files)), log_(log), thread_([this] { work(); }) {}

StateSaver::~StateSaver() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

StateSaver::Ticket StateSaver::save(const config::ParameterStore& parameters,
                                    const config::ToolTable& tools) {
  if (files_.parameters.empty() && files_.tools.empty()) return 0;
  Texts texts{parameters.to_text(), tools.to_text()};
  const std::scoped_lock lock(mutex_);
  if (newest_ != 0 && texts == newest_texts_) return newest_;
  newest_texts_ = std::move(texts);
  changed_.notify_all();
  return ++newest_;
}

std::optional<Result<void>> StateSaver::outcome(Ticket ticket) const {
  const std::scoped_lock lock(mutex_);
  if (done_ < ticket) return std::nullopt;
  return result_;
}

void StateSaver::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return done_ == newest_; });
}

Result<void> StateSaver::write(const Texts& texts, const Texts& written) const {
  if (!files_.parameters.empty() && texts.parameters != written.parameters) {
    if (auto done = config::write_file_atomically(files_.parameters, texts.parameters); !done)
      return done;
  }
  if (files_.tools.empty() || texts.tools == written.tools) return {};
  return config::write_file_atomically(files_.tools, texts.tools);
}

void StateSaver::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return done_ != newest_ || ending_; });
    if (done_ == newest_) return;
    const Texts texts = newest_texts_;
    const Texts before = written_;
    const Ticket ticket = newest_;
    lock.unlock();
    Result<void> written = write(texts, before);
    if (!written) log_.add(written.error());
    lock.lock();
    written_ = written ? texts : Texts{};
    if (!written && newest_ == ticket) newest_texts_ = {};  // the same must be written again
    done_ = ticket;
    result_ = std::move(written);
    changed_.notify_all();
  }
}

}  // namespace cnc::server
