// A queue in a ring of memory with indices that never change: element 1000 is still element 1000
// after the first 900 are gone. Grows only through reserve(), so that pushing up to the capacity
// and popping never allocate.
#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace cnc::motion {

template <typename T>
class Ring {
 public:
  explicit Ring(std::size_t capacity = 16)
      : slots_(std::bit_ceil(capacity)), mask_(slots_.size() - 1) {}

  [[nodiscard]] bool empty() const { return first_ == end_; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(end_ - first_); }
  [[nodiscard]] std::size_t free() const { return mask_ + 1 - size(); }

  /// Index of the oldest element and one past the newest.
  [[nodiscard]] std::uint64_t first() const { return first_; }
  [[nodiscard]] std::uint64_t end() const { return end_; }

  [[nodiscard]] T& operator[](std::uint64_t index) { return slots_[slot(index)]; }
  [[nodiscard]] const T& operator[](std::uint64_t index) const { return slots_[slot(index)]; }
  [[nodiscard]] T& front() { return (*this)[first_]; }
  [[nodiscard]] const T& front() const { return (*this)[first_]; }
  [[nodiscard]] T& back() { return (*this)[end_ - 1]; }
  [[nodiscard]] const T& back() const { return (*this)[end_ - 1]; }

  void push_back(T value) {
    assert(free() > 0);
    slots_[slot(end_)] = std::move(value);
    ++end_;
  }
  /// One more element at the end, to be filled in by the caller: it holds what the slot held
  /// before.
  [[nodiscard]] T& push_back() {
    assert(free() > 0);
    return slots_[slot(end_++)];
  }
  void pop_front() { ++first_; }
  void pop_back() { --end_; }
  void clear() { first_ = end_; }

  /// The same elements with the same indices; allocates only if it has less room.
  void copy(const Ring& other) {
    slots_.resize(std::max(slots_.size(), other.slots_.size()));
    mask_ = slots_.size() - 1;
    first_ = other.first_;
    end_ = other.end_;
    for (std::uint64_t i = first_; i != end_; ++i) (*this)[i] = other[i];
  }

  /// Makes room for `wanted` elements in all; allocates when that is more than ever before.
  void reserve(std::size_t wanted) {
    if (wanted <= mask_ + 1) return;
    std::vector<T> larger(std::bit_ceil(wanted));
    for (std::uint64_t i = first_; i != end_; ++i) {
      larger[static_cast<std::size_t>(i) & (larger.size() - 1)] = std::move((*this)[i]);
    }
    slots_ = std::move(larger);
    mask_ = slots_.size() - 1;
  }

 private:
  [[nodiscard]] std::size_t slot(std::uint64_t index) const {
    return static_cast<std::size_t>(index) & mask_;
  }

  std::vector<T> slots_;
  std::size_t mask_;  // their number, a power of 2, less 1: faster than to ask for it
  std::uint64_t first_ = 0;
  std::uint64_t end_ = 0;
};

}  // namespace cnc::motion
