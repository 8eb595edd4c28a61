#include "tests/motion/tube_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "motion/curve.h"

namespace cnc::motion::test {

namespace {

constexpr int kRounds = 40;

struct Stencil {
  std::array<double, 3> point;  ///< of control points i−1, i, i+1
  std::array<double, 3> bend;
};

/// The spline: node i has the control points i, i+1, i+2 around it.
class Tube {
 public:
  Tube(const std::vector<Position>& vertices, double tolerance) : tolerance_(tolerance) {
    place_nodes(vertices);
    control_ = {nodes_.front() + (nodes_.front() - nodes_[1])};
    control_.insert(control_.end(), nodes_.begin(), nodes_.end());
    control_.push_back(nodes_.back() + (nodes_.back() - nodes_[nodes_.size() - 2]));
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      stencils_.push_back(stencil(i));
      stiffest_.push_back(weight(i) / std::pow(std::max(weight(i), 2.0 * tolerance_), 4));
      stiffness_.push_back(0.1 * stiffest_[i]);
    }
    stiffness_.front() = 1e5 * stiffest_.front();
    stiffness_.back() = 1e5 * stiffest_.back();
    for (int round = 0; round < kRounds; ++round) {
      correct();
      stiffen();
    }
    correct();
  }

  [[nodiscard]] std::vector<PathInterval> intervals(double feed) const {
    std::vector<PathInterval> result;
    for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
      const double h = steps_[i];
      const Position bend = bend_at(i);
      const Position next = bend_at(i + 1);
      PathInterval interval;
      interval.length = h;
      interval.first = (point_at(i + 1) - point_at(i)) * (1.0 / h) - (2.0 * bend + next) * (h / 6);
      interval.second = bend;
      interval.third = (next - bend) * (1.0 / h);
      interval.feed = feed;
      result.push_back(interval);
    }
    return result;
  }

 private:
  void place_nodes(const std::vector<Position>& vertices) {
    std::vector<double> first_step(vertices.size(), 4.0 * tolerance_);
    for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
      const Position in = vertices[i] - vertices[i - 1];
      const Position out = vertices[i + 1] - vertices[i];
      const double shorter = std::min(norm(in), norm(out));
      const double turn =
          std::acos(std::clamp(dot(in, out) / (norm(in) * norm(out)), -1.0, 1.0)) + 1e-9;
      first_step[i] = std::min(std::max(tolerance_, 2.0 * tolerance_ / turn),
                               std::max(tolerance_, shorter / 2.0));
    }
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
      const Position way = vertices[i + 1] - vertices[i];
      for (const double part : graded(norm(way), first_step[i], first_step[i + 1])) {
        nodes_.push_back(vertices[i] + part * way);
      }
    }
    nodes_.push_back(vertices.back());
    for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
      steps_.push_back(norm(nodes_[i + 1] - nodes_[i]));
    }
  }

  /// Places of the nodes as parts of a segment: steps that grow from both ends, at least two.
  static std::vector<double> graded(double length, double from_start, double from_end) {
    std::vector<double> steps_up;
    std::vector<double> steps_down;
    double sum = 0.0;
    while (sum < length || steps_up.size() + steps_down.size() < 2) {
      const bool up = from_start <= from_end;
      double& step = up ? from_start : from_end;
      (up ? steps_up : steps_down).push_back(step);
      sum += step;
      step *= 1.7;
    }
    steps_up.insert(steps_up.end(), steps_down.rbegin(), steps_down.rend());
    std::vector<double> places;
    double place = 0.0;
    for (const double step : steps_up) {
      places.push_back(place / sum);
      place += step;
    }
    return places;
  }

  /// Knot distance i, mirrored beyond the ends.
  [[nodiscard]] double step(std::ptrdiff_t i) const {
    const auto count = std::ssize(steps_);
    if (i < 0) i = -1 - i;
    if (i >= count) i = 2 * count - 1 - i;
    return steps_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, count - 1))];
  }

  [[nodiscard]] double weight(std::size_t node) const {
    const auto i = static_cast<std::ptrdiff_t>(node);
    return 0.5 * (step(i - 1) + step(i));
  }

  [[nodiscard]] Stencil stencil(std::size_t node) const {
    const auto i = static_cast<std::ptrdiff_t>(node);
    const double before = step(i - 2) + step(i - 1) + step(i);
    const double after = step(i - 1) + step(i) + step(i + 1);
    const double both = step(i - 1) + step(i);
    const double a = step(i) * step(i) / (before * both);
    const double g = step(i - 1) * step(i - 1) / (after * both);
    return {
        {a, 1.0 - a - g, g},
        {6.0 / (both * before), -6.0 / both * (1.0 / after + 1.0 / before), 6.0 / (both * after)}};
  }

  [[nodiscard]] Position combine(std::size_t node, const std::array<double, 3>& weights) const {
    return weights[0] * control_[node] + weights[1] * control_[node + 1] +
           weights[2] * control_[node + 2];
  }
  [[nodiscard]] Position point_at(std::size_t node) const {
    return combine(node, stencils_[node].point);
  }
  [[nodiscard]] Position bend_at(std::size_t node) const {
    return combine(node, stencils_[node].bend);
  }

  /// One Newton step of min Σ W|q''|² + Σ λ|q − r|²: band elimination, half width 2.
  void correct() {
    const std::size_t size = control_.size();
    std::vector<std::array<double, 3>> band(size, {0.0, 0.0, 0.0});
    std::vector<Position> right(size);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Stencil& s = stencils_[i];
      const Position off = nodes_[i] - point_at(i);
      const Position bend = bend_at(i);
      for (std::size_t r = 0; r < 3; ++r) {
        right[i + r] += stiffness_[i] * s.point[r] * off - weight(i) * s.bend[r] * bend;
        for (std::size_t c = r; c < 3; ++c) {
          band[i + r][c - r] +=
              stiffness_[i] * s.point[r] * s.point[c] + weight(i) * s.bend[r] * s.bend[c];
        }
      }
    }
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t k = 1; k < 3 && i + k < size; ++k) {
        const double factor = band[i][k] / band[i][0];
        right[i + k] -= factor * right[i];
        for (std::size_t c = k; c < 3; ++c) band[i + k][c - k] -= factor * band[i][c];
      }
    }
    for (std::size_t i = size; i-- > 0;) {
      for (std::size_t k = 1; k < 3 && i + k < size; ++k) right[i] -= band[i][k] * right[i + k];
      right[i] *= 1.0 / band[i][0];
      control_[i] += right[i];
    }
  }

  void stiffen() {
    std::vector<double> error(nodes_.size(), 0.0);
    for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
      const Position middle = 0.5 * (point_at(i) + point_at(i + 1)) -
                              (steps_[i] * steps_[i] / 16.0) * (bend_at(i) + bend_at(i + 1));
      const double between = norm(middle - 0.5 * (nodes_[i] + nodes_[i + 1]));
      error[i] = std::max({error[i], norm(point_at(i) - nodes_[i]), between});
      error[i + 1] = std::max(error[i + 1], between);
    }
    for (std::size_t i = 1; i + 1 < nodes_.size(); ++i) {
      const double part = std::pow(error[i] / (0.91 * tolerance_), 1.5);
      stiffness_[i] = std::clamp(stiffness_[i] * std::clamp(part, 0.1, 10.0), 1e-4 * stiffest_[i],
                                 1e5 * stiffest_[i]);
    }
  }

  double tolerance_;
  std::vector<Position> nodes_;
  std::vector<double> steps_;
  std::vector<Position> control_;
  std::vector<Stencil> stencils_;
  std::vector<double> stiffest_;
  std::vector<double> stiffness_;
};

}  // namespace

std::vector<PathInterval> tube_path(const std::vector<Position>& vertices, double tolerance,
                                    double feed) {
  return Tube(vertices, tolerance).intervals(feed);
}

PathInterval straight_interval(double length, double feed) {
  PathInterval interval;
  interval.length = length;
  interval.first[Axis::X] = 1.0;
  interval.feed = feed;
  return interval;
}

}  // namespace cnc::motion::test
