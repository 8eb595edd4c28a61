// A histogram of times that a real-time thread can fill and any thread can read.
//
// Bins double from 1 µs to 1 s; recording is one relaxed increment, so the reader may see a cycle
// half counted between two bins, which no statistic minds.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>

namespace cnc::server {

class TimeHistogram {
 public:
  static constexpr std::size_t kBins = 22;

  /// Upper edge of a bin in seconds; infinity for the last.
  [[nodiscard]] static double upper_edge(std::size_t bin) {
    if (bin + 1 == kBins) return std::numeric_limits<double>::infinity();
    return 1e-6 * static_cast<double>(1U << bin);
  }

  void record(double seconds) {
    std::size_t bin = 0;
    while (bin + 1 < kBins && seconds >= upper_edge(bin)) ++bin;
    counts_[bin].fetch_add(1, std::memory_order_relaxed);
    if (seconds > max_.load(std::memory_order_relaxed))
      max_.store(seconds, std::memory_order_relaxed);
  }

  void reset() {
    for (auto& count : counts_) count.store(0, std::memory_order_relaxed);
    max_.store(0.0, std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t count(std::size_t bin) const {
    return counts_[bin].load(std::memory_order_relaxed);
  }
  [[nodiscard]] double max() const { return max_.load(std::memory_order_relaxed); }

 private:
  std::array<std::atomic<std::uint64_t>, kBins> counts_{};
  std::atomic<double> max_{0.0};
};

}  // namespace cnc::server
