// The path of a job on its way from the thread that runs the program to the one that times it
// (prediction.cpp): a bounded queue between one producer and one consumer.
//
// What is added travels hundreds of items at a time, so that neither locks nor wake-ups cost; the
// vectors that carry them go round and are not allocated again. Both sides sleep while they wait.
// abandon() may come from any thread and ends every waiting, now and later.
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <variant>
#include <vector>

#include "motion/piece.h"

namespace cnc::server {

/// The machine comes to rest behind what was added before, whatever follows, and rests so long.
struct Rest {
  double duration = 0.0;   ///< s
  std::uint64_t move = 0;  ///< the last move before it
};

using PathItem = std::variant<motion::Piece, Rest>;

class PathQueue {
 public:
  // The producer's. Waits while the queue is full; what is added once it was abandoned is lost.
  void add(const PathItem& item);
  /// Nothing will be added any more.
  void close();

  // The consumer's.
  /// Waits for the next item; nothing once all have been popped and the queue is closed, or when it
  /// was abandoned. Valid until pop().
  [[nodiscard]] const PathItem* front();
  void pop() { ++popped_; }

  void abandon();

 private:
  using Batch = std::vector<PathItem>;
  static constexpr std::size_t kBatchSize = 256;
  static constexpr std::size_t kMostBatches = 4;

  void hand_over();
  void take_over();

  Batch filled_;            // by the producer
  Batch taken_;             // by the consumer
  std::size_t popped_ = 0;  // of taken_

  std::mutex mutex_;  // protects what follows
  std::condition_variable changed_;
  std::array<Batch, kMostBatches> waiting_;  // a ring
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  bool closed_ = false;
  bool abandoned_ = false;
};

}  // namespace cnc::server
