// The iteration of the tube spline: measure, stiffen, correct.
#include <algorithm>
#include <cmath>

#include "motion/tube_spline.h"

namespace cnc::motion {

namespace {

/// The iteration aims at this part of the tolerance at the nodes and accepts the other; what is
/// left is for the path between them.
constexpr double kTarget = 0.91;
constexpr double kAccepted = 0.96;

constexpr int kRounds = 4;        // then only what leaves the tube is stiffened
constexpr int kExtraRounds = 30;  // then the run is broken

/// λ's largest value in units of λ*. An unsatisfiable node would drive it up without end.
constexpr double kLargestStiffness = 1e5;

double square(double value) { return value * value; }

}  // namespace

/// Whether the path is inside the tube up to node `last_checked`.
bool TubeSpline::relax(std::size_t last_node, std::size_t last_checked) {
  for (int round = 0;; ++round) {
    measure(last_node);
    double worst = 0.0;
    for (std::size_t i = first_row(); i <= last_checked; ++i) {
      if (!nodes_[i].fixed) worst = std::max(worst, nodes_[i].ratio);
    }
    if (round >= kRounds && worst <= kAccepted) return true;
    if (round >= kRounds + kExtraRounds) return worst <= 1.0;
    stiffen(last_node, round >= kRounds);
    correct(last_node);
  }
}

/// Position and second derivative at the nodes.
void TubeSpline::evaluate(Group& group, std::size_t last_node) const {
  group.q.resize(nodes_.size());
  group.q2.resize(nodes_.size());
  const Lanes* c = group.control.data();
  for (std::size_t i = emitted_; i <= last_node; ++i) {
    const Stencil& e = nodes_[i].position;
    const Stencil& d = nodes_[i].bend;
    group.q[i] = e.before * c[i - 1] + e.at * c[i] + e.behind * c[i + 1];
    group.q2[i] = d.before * c[i - 1] + d.at * c[i] + d.behind * c[i + 1];
  }
}

/// Distances from the program at the nodes, and half-way between them: the middle of a span counts
/// for both its nodes, across the program's direction only.
void TubeSpline::measure(std::size_t last_node) {
  const std::size_t size = nodes_.size();
  const std::size_t begin = emitted_;
  Row& at_node = diagonal_;
  Row& across = beside_;
  Row& along = beyond_;
  for (Row* row : {&at_node, &across, &along}) row->assign(size, 0.0);
  for (Group& group : groups_) {
    if (!group.moves) continue;
    evaluate(group, last_node);
    for (std::size_t i = begin; i <= last_node; ++i) {
      at_node[i] += square(group.q[i] - group.point[i]);
    }
    for (std::size_t i = begin; i < last_node; ++i) {
      const double h = nodes_[i].step;
      const Lanes off = 0.5 * (group.q[i] + group.q[i + 1]) -
                        (h * h / 16.0) * (group.q2[i] + group.q2[i + 1]) - group.middle[i];
      across[i] += square(off);
      along[i] += dot(off, group.middle_tangent[i]);
    }
  }
  double before = 0.0;
  for (std::size_t i = begin; i <= last_node; ++i) {
    const double behind = i < last_node ? across[i] - square(along[i]) : 0.0;
    nodes_[i].ratio = std::sqrt(std::max({at_node[i], before, behind})) / nodes_[i].tolerance;
    before = behind;
  }
}

void TubeSpline::stiffen(std::size_t last_node, bool offenders_only) {
  for (std::size_t i = first_row(); i <= last_node; ++i) {
    Node& node = nodes_[i];
    if (node.fixed) continue;
    const double off = node.ratio / kTarget;
    if (offenders_only) {
      if (off <= 1.0) continue;
      node.stiffness *= std::min(off * off * std::sqrt(off), 10.0);
    } else {
      node.stiffness *= std::clamp(off * std::sqrt(off), 0.1, 10.0);
    }
    node.stiffness = std::clamp(node.stiffness, least_stiffness_ * node.natural,
                                kLargestStiffness * node.natural);
  }
}

/// Newton's step from the present control points: solving for them anew would be singular to
/// rounding on long straight lines with a free end.
void TubeSpline::correct(std::size_t last_node) {
  assemble(last_node);
  factorise(free_, last_node + 2);
  for (Group& group : groups_) {
    if (!group.moves) continue;
    descend(group, last_node);
    solve(group, last_node);
  }
}

/// The matrix DᵀWD + EᵀΛE over all control points that the rows touch.
void TubeSpline::assemble(std::size_t last_node) {
  const std::size_t size = nodes_.size();
  for (Row* row : {&diagonal_, &beside_, &beyond_}) row->assign(size, 0.0);
  for (std::size_t i = first_row(); i <= last_node; ++i) {
    const Node& node = nodes_[i];
    const Stencil& e = node.position;
    const Stencil& d = node.bend;
    const double w = node.weight;
    const double l = node.stiffness;
    diagonal_[i - 1] += w * d.before * d.before + l * e.before * e.before;
    diagonal_[i] += w * d.at * d.at + l * e.at * e.at;
    diagonal_[i + 1] += w * d.behind * d.behind + l * e.behind * e.behind;
    beside_[i - 1] += w * d.before * d.at + l * e.before * e.at;
    beside_[i] += w * d.at * d.behind + l * e.at * e.behind;
    beyond_[i - 1] += w * d.before * d.behind + l * e.before * e.behind;
  }
}

/// The negative gradient.
void TubeSpline::descend(Group& group, std::size_t last_node) const {
  group.gradient.assign(nodes_.size(), Lanes{});
  Lanes* gradient = group.gradient.data();
  for (std::size_t i = first_row(); i <= last_node; ++i) {
    const Node& node = nodes_[i];
    const Lanes bend = node.weight * group.q2[i];
    const Lanes off = node.stiffness * (group.q[i] - group.point[i]);
    gradient[i - 1] = gradient[i - 1] - node.bend.before * bend - node.position.before * off;
    gradient[i] = gradient[i] - node.bend.at * bend - node.position.at * off;
    gradient[i + 1] = gradient[i + 1] - node.bend.behind * bend - node.position.behind * off;
  }
}

/// Forward and backward through the factors; the control points move by what comes out.
void TubeSpline::solve(Group& group, std::size_t last_node) const {
  Lanes* x = group.gradient.data();
  const std::size_t end = last_node + 2;
  Lanes x1;
  Lanes x2;
  for (std::size_t j = free_; j < end; ++j) {
    const double l1 = j > free_ ? beside_[j - 1] : 0.0;
    const double l2 = j > free_ + 1 ? beyond_[j - 2] : 0.0;
    const Lanes z = x[j] - l1 * x1 - l2 * x2;
    x[j] = diagonal_[j] * z;
    x2 = x1;
    x1 = z;
  }
  x1 = x2 = {};
  for (std::size_t j = end; j-- > free_;) {
    const Lanes z = x[j] - beside_[j] * x1 - beyond_[j] * x2;
    group.control[j] = group.control[j] + z;
    x2 = x1;
    x1 = z;
  }
}

/// LDLᵀ in place; the diagonal becomes 1/D.
void TubeSpline::factorise(std::size_t begin, std::size_t end) {
  double d1 = 0.0;  // of the row before, and before that
  double d2 = 0.0;
  for (std::size_t j = begin; j < end; ++j) {
    const double l1 = j > begin ? beside_[j - 1] : 0.0;
    const double l2 = j > begin + 1 ? beyond_[j - 2] : 0.0;
    const double d = diagonal_[j] - l1 * l1 * d1 - l2 * l2 * d2;
    const double inverse = 1.0 / d;
    const double next = j > begin ? beyond_[j - 1] : 0.0;
    beside_[j] = (beside_[j] - next * l1 * d1) * inverse;
    beyond_[j] *= inverse;
    diagonal_[j] = inverse;
    d2 = d1;
    d1 = d;
  }
}

}  // namespace cnc::motion
