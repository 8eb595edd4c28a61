#include "hal/trace/ring.h"

#include <algorithm>

namespace cnc::hal::trace {

Ring::Ring(std::size_t words)
    : size_(std::max<std::size_t>(words, 1024)),
      words_(std::make_unique<std::atomic<std::uint64_t>[]>(size_)) {}

void Ring::append(std::span<const std::uint64_t> record) {
  const std::uint64_t begin = end_.load(std::memory_order_relaxed);
  const std::uint64_t end = begin + record.size();
  std::uint64_t oldest = oldest_.load(std::memory_order_relaxed);
  while (end - oldest > size_)
    oldest += RecordHead::from(words_[oldest % size_].load(std::memory_order_relaxed)).words();
  oldest_.store(oldest, std::memory_order_relaxed);
  std::uint64_t index = begin % size_;
  for (const std::uint64_t word : record) {
    words_[index].store(word, std::memory_order_release);
    index = index_after(index);
  }
  end_.store(end, std::memory_order_release);
}

std::vector<std::uint64_t> Ring::copy() const {
  const std::uint64_t end = end_.load(std::memory_order_acquire);
  const std::uint64_t begin = oldest_.load(std::memory_order_acquire);
  if (begin >= end) return {};
  std::vector<std::uint64_t> words;
  words.reserve(end - begin);
  std::uint64_t index = begin % size_;
  for (std::uint64_t place = begin; place < end; ++place) {
    words.push_back(words_[index].load(std::memory_order_acquire));
    index = index_after(index);
  }
  const std::uint64_t whole = std::min(oldest_.load(std::memory_order_acquire), end);
  words.erase(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(whole - begin));
  return words;
}

}  // namespace cnc::hal::trace
