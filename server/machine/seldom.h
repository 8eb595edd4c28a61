// A message that may be due at any rate, a flickering input's say, is told at once, and then not
// more than once a second, with how often it was due: the log keeps room for others.
#pragma once

#include <limits>
#include <optional>
#include <utility>

namespace cnc::server {

class Seldom {
 public:
  static constexpr double kInterval = 1.0;  // s

  /// It is due `times` more. How often it has been since it was last told, if it is to be told now.
  std::optional<unsigned> due(unsigned times, double now) {
    untold_ += times;
    if (untold_ == 0 || now < told_at_ + kInterval) return std::nullopt;
    told_at_ = now;
    return std::exchange(untold_, 0U);
  }

 private:
  double told_at_ = -std::numeric_limits<double>::infinity();
  unsigned untold_ = 0;
};

}  // namespace cnc::server
