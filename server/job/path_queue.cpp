#include "server/job/path_queue.h"

#include <utility>

namespace cnc::server {

void PathQueue::add(const PathItem& item) {
  filled_.push_back(item);
  if (filled_.size() >= kBatchSize) hand_over();
}

void PathQueue::close() {
  if (!filled_.empty()) hand_over();
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  changed_.notify_one();
}

/// The producer goes on with the empty vector that it gets in exchange.
void PathQueue::hand_over() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return count_ < kMostBatches || abandoned_; });
  if (!abandoned_) {
    std::swap(filled_, waiting_[(first_ + count_) % kMostBatches]);
    ++count_;
    changed_.notify_one();
  }
  filled_.clear();
}

const PathItem* PathQueue::front() {
  if (popped_ == taken_.size()) take_over();
  return taken_.empty() ? nullptr : &taken_[popped_];
}

void PathQueue::take_over() {
  taken_.clear();
  popped_ = 0;
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return count_ > 0 || closed_ || abandoned_; });
  if (count_ == 0 || abandoned_) return;
  std::swap(taken_, waiting_[first_]);
  first_ = (first_ + 1) % kMostBatches;
  --count_;
  changed_.notify_one();
}

void PathQueue::abandon() {
  const std::scoped_lock lock(mutex_);
  abandoned_ = true;
  changed_.notify_all();
}

}  // namespace cnc::server
