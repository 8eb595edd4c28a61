#include "motion/tube_relaxation.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

namespace {

/// Part of the tolerance that is accepted; what is left is for the path between the nodes.
constexpr double kAccepted = 0.96;

constexpr int kRounds = 4;        // then only what leaves the tube is stiffened
constexpr int kExtraRounds = 30;  // then the run is broken

double square(double value) { return value * value; }

// Without a branch, unlike those of the library on elements of rows.
double smaller(double a, double b) { return a < b ? a : b; }
double larger(double a, double b) { return a > b ? a : b; }

std::size_t first_row(std::size_t free) { return std::max(kFirstNode, free - 1); }

// The loops over the nodes are functions of their own whose rows are declared not to overlap: only
// then are several nodes done at once.

/// A stencil applied to the control points around the nodes from `begin` to `end` − 1.
void apply(const Stencils& __restrict stencils, const NodeRow& __restrict c, std::size_t begin,
           std::size_t end, NodeRow& __restrict result) {
  for (std::size_t i = begin; i < end; ++i) {
    result[i] =
        stencils.before[i] * c[i - 1] + stencils.at[i] * c[i] + stencils.behind[i] * c[i + 1];
  }
}

void add_squares(const NodeRow& __restrict a, const NodeRow& __restrict b, std::size_t begin,
                 std::size_t end, NodeRow& __restrict difference, NodeRow& __restrict squares) {
  for (std::size_t i = begin; i < end; ++i) {
    difference[i] = a[i] - b[i];
    squares[i] += difference[i] * difference[i];
  }
}

/// What one axis adds to the distances half-way between two nodes.
void add_middles(const NodeRow& __restrict q, const NodeRow& __restrict q2,
                 const NodeRow& __restrict sag, const TubeNodes::AxisRows& __restrict program,
                 std::size_t begin, std::size_t end, NodeRow& __restrict squares,
                 NodeRow& __restrict along) {
  for (std::size_t i = begin; i < end; ++i) {
    const double middle = 0.5 * (q[i] + q[i + 1]) - sag[i] * (q2[i] + q2[i + 1]);
    const double off = middle - program.middle[i];
    squares[i] += off * off;
    along[i] += off * program.middle_tangent[i];
  }
}

/// The largest distance at each node and half-way to its neighbours.
void collect_largest(const NodeRow& __restrict at_node, const NodeRow& __restrict along,
                     const NodeRow& __restrict scale, std::size_t last, NodeRow& __restrict across,
                     NodeRow& __restrict largest) {
  for (std::size_t i = kFirstNode; i < last; ++i) across[i] -= along[i] * along[i];
  for (std::size_t i = kFirstNode; i <= last; ++i) {
    largest[i] = scale[i] * larger(at_node[i], larger(across[i - 1], across[i]));
  }
}

/// Multiplies the stiffnesses by `factor` of the squared distance over the target.
template <typename Factor>
void stiffen(const NodeRow& __restrict off, const NodeRow& __restrict least,
             const NodeRow& __restrict most, std::size_t begin, std::size_t end,
             NodeRow& __restrict stiffness, Factor factor) {
  for (std::size_t i = begin; i < end; ++i) {
    stiffness[i] = larger(least[i], smaller(most[i], stiffness[i] * factor(off[i])));
  }
}

double balance(double off_squared) {
  const double off = std::sqrt(off_squared);
  return larger(0.1, smaller(10.0, off * std::sqrt(off)));
}

/// The power of 2.5 of the distance; (3 + 5x) / (5 + 3x) is Padé's approximation of a fourth root.
double stiffen_offender(double off_squared) {
  const double root = (3.0 + 5.0 * off_squared) / (5.0 + 3.0 * off_squared);
  return larger(1.0, smaller(10.0, off_squared * root));
}

void multiply(const NodeRow& __restrict a, const NodeRow& __restrict b, std::size_t begin,
              std::size_t end, NodeRow& __restrict product) {
  for (std::size_t i = begin; i < end; ++i) product[i] = a[i] * b[i];
}

/// The negative gradient: what the nodes' forces and moments do to each control point.
void gather(const Stencils& __restrict e, const NodeRow& __restrict force,
            const Stencils& __restrict d, const NodeRow& __restrict moment, std::size_t begin,
            std::size_t end, NodeRow& __restrict downhill) {
  for (std::size_t j = begin; j < end; ++j) {
    downhill[j] =
        -(d.before[j + 1] * moment[j + 1] + d.at[j] * moment[j] + d.behind[j - 1] * moment[j - 1] +
          e.before[j + 1] * force[j + 1] + e.at[j] * force[j] + e.behind[j - 1] * force[j - 1]);
  }
}

void add(const NodeRow& __restrict a, std::size_t begin, std::size_t end, NodeRow& __restrict sum) {
  for (std::size_t i = begin; i < end; ++i) sum[i] += a[i];
}

/// The matrix DᵀWD + EᵀΛE.
void assemble(const FiveDiagonals& __restrict bending, const StiffnessShares& __restrict share,
              const NodeRow& __restrict l, std::size_t begin, std::size_t end,
              FiveDiagonals& __restrict matrix) {
  for (std::size_t j = begin; j < end; ++j) {
    matrix.diagonal[j] = bending.diagonal[j] + l[j + 1] * share.before[j + 1] + l[j] * share.at[j] +
                         l[j - 1] * share.behind[j - 1];
    matrix.beside[j] =
        bending.beside[j] + l[j] * share.at_behind[j] + l[j + 1] * share.before_at[j + 1];
    matrix.beyond[j] = bending.beyond[j] + l[j + 1] * share.before_behind[j + 1];
  }
}

}  // namespace

bool TubeRelaxation::relax(TubeNodes& nodes, std::size_t free, std::size_t last,
                           std::size_t last_checked) {
  const std::size_t first = first_row(free);
  prepare(nodes, last);
  for (int round = 0;; ++round) {
    measure(nodes, last);
    if (round >= kRounds && within(kAccepted, first, last_checked)) return true;
    if (round >= kRounds + kExtraRounds) return within(1.0, first, last_checked);
    const auto stiffen_by = [&](auto factor) {
      stiffen(off_, nodes.least_stiffness, nodes.most_stiffness, first, last + 1, nodes.stiffness,
              factor);
    };
    if (round < kRounds) {
      stiffen_by([](double off) { return balance(off); });
    } else {
      stiffen_by([](double off) { return stiffen_offender(off); });
    }
    correct(nodes, free, last);
  }
}

bool TubeRelaxation::within(double part, std::size_t first, std::size_t last) const {
  return std::all_of(off_.begin() + first, off_.begin() + last + 1,
                     [limit = square(part / kTarget)](double off) { return off <= limit; });
}

/// Rows of the matrix exist for the nodes whose weight is not 0.
void TubeRelaxation::prepare(const TubeNodes& nodes, std::size_t last) {
  const Stencils& e = nodes.position;
  const Stencils& d = nodes.bend;
  const NodeRow& w = nodes.weight;
  for (std::size_t i = kFirstNode; i <= last; ++i) {
    scale_[i] = nodes.fixed[i] ? 0.0 : 1.0 / square(kTarget * nodes.tolerance[i]);
    sag_[i] = nodes.step[i] * nodes.step[i] / 16.0;
  }
  for (std::size_t i = kFirstNode; i <= last + 2; ++i) {
    share_.before[i] = e.before[i] * e.before[i];
    share_.at[i] = e.at[i] * e.at[i];
    share_.behind[i] = e.behind[i] * e.behind[i];
    share_.before_at[i] = e.before[i] * e.at[i];
    share_.at_behind[i] = e.at[i] * e.behind[i];
    share_.before_behind[i] = e.before[i] * e.behind[i];
  }
  for (std::size_t j = kFirstNode - 1; j <= last + 1; ++j) {
    bending_.diagonal[j] = w[j + 1] * d.before[j + 1] * d.before[j + 1] + w[j] * d.at[j] * d.at[j] +
                           w[j - 1] * d.behind[j - 1] * d.behind[j - 1];
    bending_.beside[j] = w[j] * d.at[j] * d.behind[j] + w[j + 1] * d.before[j + 1] * d.at[j + 1];
    bending_.beyond[j] = w[j + 1] * d.before[j + 1] * d.behind[j + 1];
  }
}

/// Distances from the program at the nodes, and half-way between them: the middle of a span counts
/// for both its nodes, across the program's direction only.
void TubeRelaxation::measure(const TubeNodes& nodes, std::size_t last) {
  at_node_.fill(0.0);
  across_.fill(0.0);
  along_.fill(0.0);
  for (const Axis axis : kAllAxes) {
    if (!nodes.moves[axis]) continue;
    const TubeNodes::AxisRows& program = nodes.axes[axis];
    Measured& path = measured_[axis];
    apply(nodes.position, program.control, kFirstNode, last + 1, path.q);
    apply(nodes.bend, program.control, kFirstNode, last + 1, path.q2);
    add_squares(path.q, program.point, kFirstNode, last + 1, path.off, at_node_);
    add_middles(path.q, path.q2, sag_, program, kFirstNode, last, across_, along_);
  }
  collect_largest(at_node_, along_, scale_, last, across_, off_);
}

/// Newton's step from the present control points: solving for them anew would be singular to
/// rounding on long straight lines with a free end.
void TubeRelaxation::correct(TubeNodes& nodes, std::size_t free, std::size_t last) {
  assemble(bending_, share_, nodes.stiffness, free, last + 2, matrix_);
  factors_.factorise(matrix_, free, last + 2);
  for (const auto& group : {kLinearAxes, kRotaryAxes}) {
    if (std::none_of(group.begin(), group.end(), [&](Axis axis) { return nodes.moves[axis]; })) {
      continue;
    }
    for (const Axis axis : group) {
      if (nodes.moves[axis]) descend(nodes, axis, free, last);
    }
    factors_.solve({&measured_[group[0]].correction, &measured_[group[1]].correction,
                    &measured_[group[2]].correction});
    for (const Axis axis : group) {
      if (!nodes.moves[axis]) continue;
      add(measured_[axis].correction, free, last + 2, nodes.axes[axis].control);
    }
  }
}

void TubeRelaxation::descend(const TubeNodes& nodes, Axis axis, std::size_t free,
                             std::size_t last) {
  NodeRow& force = at_node_;
  NodeRow& moment = across_;
  multiply(nodes.stiffness, measured_[axis].off, kFirstNode, last + 1, force);
  multiply(nodes.weight, measured_[axis].q2, kFirstNode, last + 1, moment);
  for (const std::size_t i : {kFirstNode - 2, kFirstNode - 1, last + 1, last + 2}) {
    force[i] = moment[i] = 0.0;
  }
  gather(nodes.position, force, nodes.bend, moment, free, last + 2, measured_[axis].correction);
  measured_[axis].correction[last + 2] = 0.0;
}

}  // namespace cnc::motion
