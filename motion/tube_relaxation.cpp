#include "motion/tube_relaxation.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

namespace {

/// Parts of the tolerance: what the iteration aims at, what is accepted, and what is accepted on a
/// closer look. The rest is for the path between the places at which it is measured.
constexpr double kTarget = 0.93;
constexpr double kAccepted = 0.98;
constexpr double kAcceptedClosely = 0.99;
constexpr double kPerTarget = 1.0 / (kTarget * kTarget);

constexpr int kRounds = 4;        // then only what leaves the tube is stiffened
constexpr int kExtraRounds = 30;  // then the run is broken

double square(double value) { return value * value; }

// Without a branch, unlike those of the library on elements of rows.
double smaller(double a, double b) { return a < b ? a : b; }
double larger(double a, double b) { return a > b ? a : b; }

std::size_t first_row(std::size_t free) { return std::max(kFirstNode, free - 1); }

// The loops over the nodes are functions of their own whose rows are declared not to overlap: only
// then are several nodes done at once.

constexpr std::size_t kGroup = TubeNodes::kGroup;
using GroupRows = TubeDistance::GroupRows;

/// Multiplies the stiffnesses by `factor` of the squared distance over the part of the tolerance
/// that is aimed at.
template <typename Factor>
void stiffen(const NodeRow& __restrict off, const NodeRow& __restrict least,
             const NodeRow& __restrict most, std::size_t begin, std::size_t end,
             NodeRow& __restrict stiffness, Factor factor) {
  for (std::size_t i = begin; i < end; ++i) {
    stiffness[i] = larger(least[i], smaller(most[i], stiffness[i] * factor(off[i] * kPerTarget)));
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
                   const GroupRows& __restrict off, GroupRows& __restrict forces) {
  for (std::size_t j = begin; j < end; ++j) {
    const double before = e.before[j + 1] * (balance[j + 1] - stiffness[j + 1]);
    const double at = e.at[j] * (balance[j] - stiffness[j]);
    const double behind = e.behind[j - 1] * (balance[j - 1] - stiffness[j - 1]);
    for (std::size_t a = 0; a < kGroup; ++a) {
      forces[a][j] = before * off[a][j + 1] + at * off[a][j] + behind * off[a][j - 1];
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
  distance_.prepare(nodes, last);
  for (int round = 0;; ++round) {
    distance_.measure(nodes, last);
    const bool is_last = round == kRounds + kExtraRounds;
    if (is_last || (round >= kRounds && within(kAccepted, first, last_checked))) {
      distance_.look_closely(nodes, std::min(last, last_checked + 1));
      if (within(kAcceptedClosely, first, last_checked)) return true;
    }
    if (is_last) return false;
    const auto stiffen_by = [&](auto factor) {
      stiffen(distance_.largest(), nodes.least_stiffness, nodes.most_stiffness, first, last + 1,
              nodes.stiffness, factor);
    };
    if (round < kRounds) {
      stiffen_by([](double off) { return adjust(off); });
    } else {
      stiffen_by([](double off) { return stiffen_offender(off); });
    }
    correct(nodes, free, last, round > 0);
  }
}

bool TubeRelaxation::is_outside(std::size_t node) const {
  return distance_.largest()[node] > square(kAcceptedClosely);
}

bool TubeRelaxation::within(double part, std::size_t first, std::size_t last) const {
  const NodeRow& off = distance_.largest();
  return std::all_of(off.begin() + first, off.begin() + last + 1,
                     [part](double value) { return value <= square(part); });
}

/// Rows of the matrix exist for the nodes whose weight is not 0.
void TubeRelaxation::prepare(const TubeNodes& nodes, std::size_t last) {
  const Stencils& e = nodes.position;
  const Stencils& d = nodes.bend;
  const NodeRow& w = nodes.weight;
  balance_.fill(0.0);
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

/// Newton's step from the present control points: solving for them anew would be singular to
/// rounding on long straight lines with a free end. `in_balance`: they are a solution for what the
/// stiffnesses were.
void TubeRelaxation::correct(TubeNodes& nodes, std::size_t free, std::size_t last,
                             bool in_balance) {
  const std::size_t end = last + 2;
  assemble(bending_, share_, nodes.stiffness, free, end, matrix_);
  factors_.factorise(matrix_, free, end);
  for (std::size_t group = 0; group < kAxisCount / kGroup; ++group) {
    if (!nodes.moves_in(group)) continue;
    TubeNodes::AxisRows* axes = nodes.group(group);
    GroupRows& x = correction_;
    gather_forces(nodes.position, nodes.stiffness, balance_, free, end, distance_.off(group), x);
    for (std::size_t a = 0; a < kGroup; ++a) {
      if (!in_balance) add_moments(nodes, axes[a].control, free, end, x[a]);
      x[a][end] = 0.0;
    }
    factors_.solve({&x[0], &x[1], &x[2]});
    for (std::size_t a = 0; a < kGroup; ++a) add(x[a], free, end, axes[a].control);
  }
  balance_ = nodes.stiffness;
}

}  // namespace cnc::motion
