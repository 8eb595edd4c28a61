#include "motion/tube_relaxation.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

namespace {

/// Part of the tolerance that is accepted; what is left is for the path between the nodes, which is
/// not quite a parabola.
constexpr double kAccepted = 0.97;

constexpr int kRounds = 4;        // then only what leaves the tube is stiffened
constexpr int kExtraRounds = 30;  // then the run is broken

double square(double value) { return value * value; }

// Without a branch, unlike those of the library on elements of rows.
double smaller(double a, double b) { return a < b ? a : b; }
double larger(double a, double b) { return a > b ? a : b; }

std::size_t first_row(std::size_t free) { return std::max(kFirstNode, free - 1); }

// The loops over the nodes are functions of their own whose rows are declared not to overlap: only
// then are several nodes done at once.

using Rows = TubeNodes::AxisRows;

constexpr std::size_t kGroup = TubeRelaxation::kGroup;

/// Squares of the distances at the nodes, and half-way to the next ones, there also along the
/// program's direction. Three axes together, and added to what others came to.
void add_distances(const Stencils& __restrict e, const MiddleStencils& __restrict m,
                   const Rows* __restrict axes, std::size_t last,
                   TubeRelaxation::GroupPath& __restrict path, NodeRow& __restrict at_node,
                   NodeRow& __restrict half_way, NodeRow& __restrict along) {
  for (std::size_t i = kFirstNode; i <= last; ++i) {
    double at = at_node[i];
    double middle_square = half_way[i];
    double middle_along = along[i];
    for (std::size_t a = 0; a < kGroup; ++a) {
      const NodeRow& c = axes[a].control;
      const double q = e.before[i] * c[i - 1] + e.at[i] * c[i] + e.behind[i] * c[i + 1];
      const double off = q - axes[a].point[i];
      path[a].off[i] = off;
      at += off * off;
      const double middle = m.weight[0][i] * c[i - 1] + m.weight[1][i] * c[i] +
                            m.weight[2][i] * c[i + 1] + m.weight[3][i] * c[i + 2];
      const double aside = middle - axes[a].middle[i];
      middle_square += aside * aside;
      middle_along += aside * axes[a].middle_tangent[i];
    }
    at_node[i] = at;
    half_way[i] = middle_square;
    along[i] = middle_along;
  }
}

/// The largest value of a parabola if that lies between its ends, otherwise the one half-way.
double peak_between(double begin, double half_way, double end) {
  const double bow = 2.0 * half_way - begin - end;
  const double rise = end - begin;
  const double peak = half_way + rise * rise / (8.0 * bow);
  return std::abs(rise) < 2.0 * bow ? peak : half_way;
}

/// The largest distance at each node and on the way to its neighbours: its square as a parabola
/// through what it is at both and half-way, there across the program's direction only.
void collect_largest(const NodeRow& __restrict at_node, const NodeRow& __restrict along,
                     const NodeRow& __restrict scale, std::size_t last,
                     NodeRow& __restrict half_way, NodeRow& __restrict largest) {
  for (std::size_t i = kFirstNode; i < last; ++i) {
    half_way[i] = peak_between(at_node[i], half_way[i] - along[i] * along[i], at_node[i + 1]);
  }
  half_way[last] = 0.0;
  for (std::size_t i = kFirstNode; i <= last; ++i) {
    largest[i] = scale[i] * larger(at_node[i], larger(half_way[i - 1], half_way[i]));
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

/// The power of 1.5 of the distance: less stiffness where there is room.
double adjust(double off_squared) {
  const double off = std::sqrt(off_squared);
  return larger(0.1, smaller(10.0, off * std::sqrt(off)));
}

/// The power of 2.5 of the distance; (3 + 5x) / (5 + 3x) is Padé's approximation of a fourth root.
double stiffen_offender(double off_squared) {
  const double root = (3.0 + 5.0 * off_squared) / (5.0 + 3.0 * off_squared);
  return larger(1.0, smaller(10.0, off_squared * root));
}

/// The negative gradient of what changed since the control points were a solution: stiffnesses.
void gather_forces(const Stencils& __restrict e, const NodeRow& __restrict stiffness,
                   const NodeRow& __restrict balance, std::size_t begin, std::size_t end,
                   TubeRelaxation::GroupPath& __restrict path) {
  for (std::size_t j = begin; j < end; ++j) {
    const double before = e.before[j + 1] * (balance[j + 1] - stiffness[j + 1]);
    const double at = e.at[j] * (balance[j] - stiffness[j]);
    const double behind = e.behind[j - 1] * (balance[j - 1] - stiffness[j - 1]);
    for (std::size_t a = 0; a < kGroup; ++a) {
      const NodeRow& off = path[a].off;
      path[a].correction[j] = before * off[j + 1] + at * off[j] + behind * off[j - 1];
    }
  }
}

/// The bending's part of it, when they were no solution at all.
void add_moments(const TubeNodes& nodes, const NodeRow& c, std::size_t begin, std::size_t end,
                 NodeRow& __restrict downhill) {
  const Stencils& d = nodes.bend;
  NodeRow moment{};
  for (std::size_t i = kFirstNode; i + 1 < end; ++i) {
    moment[i] =
        nodes.weight[i] * (d.before[i] * c[i - 1] + d.at[i] * c[i] + d.behind[i] * c[i + 1]);
  }
  for (std::size_t j = begin; j < end; ++j) {
    downhill[j] -=
        d.before[j + 1] * moment[j + 1] + d.at[j] * moment[j] + d.behind[j - 1] * moment[j - 1];
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
      stiffen_by([](double off) { return adjust(off); });
    } else {
      stiffen_by([](double off) { return stiffen_offender(off); });
    }
    correct(nodes, free, last, round > 0);
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
  balance_.fill(0.0);
  for (std::size_t i = kFirstNode; i <= last; ++i) {
    scale_[i] = nodes.fixed[i] ? 0.0 : 1.0 / square(kTarget * nodes.tolerance[i]);
  }
  // ½ (q + q of the next node) − h²/16 (q'' + q'' of the next node); nothing behind the last node.
  for (std::size_t i = kFirstNode; i < last; ++i) {
    const double sag = square(nodes.step[i]) / 16.0;
    middle_.weight[0][i] = 0.5 * e.before[i] - sag * d.before[i];
    middle_.weight[1][i] = 0.5 * (e.at[i] + e.before[i + 1]) - sag * (d.at[i] + d.before[i + 1]);
    middle_.weight[2][i] = 0.5 * (e.behind[i] + e.at[i + 1]) - sag * (d.behind[i] + d.at[i + 1]);
    middle_.weight[3][i] = 0.5 * e.behind[i + 1] - sag * d.behind[i + 1];
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
    bending_.diagonal[j] = w[j + 1] * square(d.before[j + 1]) + w[j] * square(d.at[j]) +
                           w[j - 1] * square(d.behind[j - 1]);
    bending_.beside[j] = w[j] * d.at[j] * d.behind[j] + w[j + 1] * d.before[j + 1] * d.at[j + 1];
    bending_.beyond[j] = w[j + 1] * d.before[j + 1] * d.behind[j + 1];
  }
}

void TubeRelaxation::measure(const TubeNodes& nodes, std::size_t last) {
  at_node_.fill(0.0);
  half_way_.fill(0.0);
  along_.fill(0.0);
  for (std::size_t group = 0; group < path_.size(); ++group) {
    if (!nodes.moves_in(group)) continue;
    add_distances(nodes.position, middle_, nodes.group(group), last, path_[group], at_node_,
                  half_way_, along_);
  }
  collect_largest(at_node_, along_, scale_, last, half_way_, off_);
}

/// Newton's step from the present control points: solving for them anew would be singular to
/// rounding on long straight lines with a free end. `in_balance`: they are a solution for what the
/// stiffnesses were.
void TubeRelaxation::correct(TubeNodes& nodes, std::size_t free, std::size_t last,
                             bool in_balance) {
  const std::size_t end = last + 2;
  assemble(bending_, share_, nodes.stiffness, free, end, matrix_);
  factors_.factorise(matrix_, free, end);
  for (std::size_t group = 0; group < path_.size(); ++group) {
    if (!nodes.moves_in(group)) continue;
    GroupPath& path = path_[group];
    TubeNodes::AxisRows* axes = nodes.group(group);
    gather_forces(nodes.position, nodes.stiffness, balance_, free, end, path);
    for (std::size_t a = 0; a < kGroup; ++a) {
      if (!in_balance) add_moments(nodes, axes[a].control, free, end, path[a].correction);
      path[a].correction[end] = 0.0;
    }
    factors_.solve({&path[0].correction, &path[1].correction, &path[2].correction});
    for (std::size_t a = 0; a < kGroup; ++a) add(path[a].correction, free, end, axes[a].control);
  }
  balance_ = nodes.stiffness;
}

}  // namespace cnc::motion
