// Says why the board is not there: once, and only when that lasts. A board that was lost is busy or
// silent for a moment before it is welcome again.
#pragma once

#include <optional>

#include "hal/link_obstacle.h"

namespace cnc::server {

class ObstacleWatch {
 public:
  static constexpr double kPatience = 2.0;  // s

  /// What is to be told now.
  [[nodiscard]] std::optional<Error> look(const hal::LinkObstacle& obstacle, double now) {
    if (obstacle != obstacle_) {
      obstacle_ = obstacle;
      since_ = now;
      is_told_ = obstacle.kind == hal::LinkObstacle::Kind::none;
    }
    if (is_told_ || now - since_ < kPatience) return std::nullopt;
    is_told_ = true;
    return hal::error_of(obstacle_);
  }

 private:
  hal::LinkObstacle obstacle_{};
  double since_ = 0.0;
  bool is_told_ = true;
};

}  // namespace cnc::server
