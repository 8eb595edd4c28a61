#include "motion/tube_nodes.h"

#include <algorithm>
#include <cassert>

namespace cnc::motion {

namespace {

/// λ in units of λ* at the beginning.
constexpr double kFirstStiffness = 0.1;

/// λ's largest value in units of λ*. An unsatisfiable node would drive it up without end.
constexpr double kLargestStiffness = 1e5;

/// λ at the ends of a run in units of W⁻³, the size of the bending's own entries in the matrix.
constexpr double kEndStiffness = 1e5;

/// A tube wider than so many steps counts as narrower in λ*: bending and stiffness, whose ratio
/// goes with its fourth power, have to stand beside each other in the digits of one matrix.
constexpr double kWidestTube = 300.0;

double square(double value) { return value * value; }

}  // namespace

void TubeNodes::push(const Position& point, double node_tolerance) {
  assert(count + 1 < kMostNodes);
  const std::size_t i = count++;
  tolerance[i] = node_tolerance;
  fixed[i] = false;
  step[i] = weight[i] = stiffness[i] = 0.0;
  for (const Axis axis : kAllAxes) axes[axis].point[i] = axes[axis].control[i] = point[axis];
}

void TubeNodes::drop_before(std::size_t i) {
  const auto drop = [this, i](auto& row) {
    std::copy(row.begin() + i, row.begin() + count, row.begin());
  };
  for (NodeRow* row :
       {&step, &tolerance, &weight, &stiffness, &least_stiffness, &most_stiffness, &position.before,
        &position.at, &position.behind, &bend.before, &bend.at, &bend.behind}) {
    drop(*row);
  }
  drop(fixed);
  for (AxisRows& axis : axes.values) {
    for (NodeRow* row : {&axis.point, &axis.control, &axis.middle, &axis.middle_tangent})
      drop(*row);
  }
  count -= i;
}

void TubeNodes::complete(std::size_t i, double least) {
  const double h0 = step[i - 2];
  const double h1 = step[i - 1];
  const double h2 = step[i];
  const double h3 = step[i + 1];
  const double before = 1.0 / ((h0 + h1 + h2) * (h1 + h2));
  const double behind = 1.0 / ((h1 + h2 + h3) * (h1 + h2));
  position.before[i] = h2 * h2 * before;
  position.behind[i] = h1 * h1 * behind;
  position.at[i] = 1.0 - position.before[i] - position.behind[i];
  bend.before[i] = 6.0 * before;
  bend.behind[i] = 6.0 * behind;
  bend.at[i] = -bend.before[i] - bend.behind[i];

  weight[i] = 0.5 * (h1 + h2);
  if (fixed[i]) {
    stiffness[i] = kEndStiffness / (weight[i] * square(weight[i]));
    least_stiffness[i] = most_stiffness[i] = stiffness[i];
  } else {
    const double width = std::clamp(2.0 * tolerance[i], weight[i], kWidestTube * weight[i]);
    const double natural = weight[i] / square(square(width));
    stiffness[i] = kFirstStiffness * natural;
    least_stiffness[i] = least * natural;
    most_stiffness[i] = kLargestStiffness * natural;
  }
}

}  // namespace cnc::motion
