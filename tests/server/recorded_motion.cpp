#include "tests/server/recorded_motion.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

namespace cnc::server::test {
namespace {

using motion::AxisCubic;
using motion::norm;
using motion::Setpoint;

/// One setpoint of a stream: where it begins, and the cubics to its end.
struct Piece {
  Position position;
  Position velocity;
  const Setpoint& setpoint;

  [[nodiscard]] Position at(double t) const {
    Position p;
    for (const Axis axis : kAllAxes)
      p[axis] = motion::cubic_of(axis, position, velocity, setpoint).position(t);
    return p;
  }
  [[nodiscard]] Position velocity_at(double t) const {
    Position v;
    for (const Axis axis : kAllAxes)
      v[axis] = motion::cubic_of(axis, position, velocity, setpoint).velocity(t);
    return v;
  }
};

template <typename Visit>
void for_each_piece(const std::vector<Setpoint>& setpoints, Visit visit) {
  Position position;
  Position velocity;
  for (const Setpoint& setpoint : setpoints) {
    visit(Piece{position, velocity, setpoint});
    position = setpoint.position;
    velocity = setpoint.velocity;
  }
}

/// Newton's method from several places: a piece may begin or end at rest.
double distance(const Piece& piece, const Position& p) {
  const double duration = piece.setpoint.duration;
  double least = std::min(norm(p - piece.at(0.0)), norm(p - piece.at(duration)));
  for (const double begin : {0.1, 0.5, 0.9}) {
    double t = begin * duration;
    for (int i = 0; i < 20; ++i) {
      const Position v = piece.velocity_at(t);
      const double square = dot(v, v);
      if (square == 0.0) break;
      const double next = std::clamp(t + dot(p - piece.at(t), v) / square, 0.0, duration);
      if (std::abs(next - t) < 1e-15) break;
      t = next;
    }
    least = std::min(least, norm(p - piece.at(t)));
  }
  return least;
}

/// Follows a path forward.
class Follower {
 public:
  explicit Follower(const std::vector<Setpoint>& path) {
    for_each_piece(path, [&](const Piece& piece) { pieces_.push_back(piece); });
  }
  [[nodiscard]] double distance_to(const Position& p) {
    constexpr std::size_t kWindow = 400;  // pieces; 2 s of the longest
    constexpr double kOnIt = 1e-7;
    double least = distance(pieces_[here_], p);
    const std::size_t end = std::min(here_ + kWindow, pieces_.size());
    for (std::size_t i = here_ + 1; i < end && least > kOnIt; ++i) {
      const double there = distance(pieces_[i], p);
      if (there >= least) continue;
      least = there;
      here_ = i;
    }
    return least;
  }

 private:
  std::vector<Piece> pieces_;
  std::size_t here_ = 0;
};

}  // namespace

RecordedMotion::RecordedMotion(Rig& rig) {
  rig.machine.set_setpoint_listener([this, &rig](const Setpoint& setpoint) {
    // The link takes it to the board in its next cycle.
    if (setpoints_.empty()) begin_ = rig.simulation.time();
    setpoints_.push_back(setpoint);
  });
  rig.machine.set_cut_listener([this](std::size_t count) {
    REQUIRE(count <= setpoints_.size());
    setpoints_.resize(setpoints_.size() - count);
    kept_ = setpoints_.size();
    ++cuts_;
  });
}

double RecordedMotion::duration() const {
  double sum = 0.0;
  for (const Setpoint& setpoint : setpoints_) sum += setpoint.duration;
  return sum;
}

double RecordedMotion::end_of_kept() const {
  double time = begin_;
  for (std::size_t i = 0; i < kept_; ++i) time += setpoints_[i].duration;
  return time;
}

double RecordedMotion::usage(const config::MachineConfig& config) const {
  double usage = 0.0;
  for_each_piece(setpoints_, [&](const Piece& piece) {
    for (const Axis axis : kLinearAxes) {
      const AxisCubic cubic =
          motion::cubic_of(axis, piece.position, piece.velocity, piece.setpoint);
      const config::AxisConfig& limits = config.axes[axis];
      usage = std::max({usage, cubic.fastest() / limits.velocity,
                        std::abs(cubic.start_acceleration()) / limits.acceleration,
                        std::abs(cubic.end_acceleration()) / limits.acceleration});
    }
  });
  return usage;
}

double RecordedMotion::distance_from(const RecordedMotion& other) const {
  Follower follower(other.setpoints_);
  double largest = 0.0;
  for_each_piece(setpoints_, [&](const Piece& piece) {
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
      const Position p = piece.at(part * piece.setpoint.duration);
      largest = std::max(largest, follower.distance_to(p));
    }
  });
  return largest;
}

}  // namespace cnc::server::test
