#include "motion/tube_distance.h"

#include <algorithm>
#include <cmath>

namespace cnc::motion {

namespace {

double square(double value) { return value * value; }

// Without a branch, unlike that of the library on elements of rows.
double larger(double a, double b) { return a > b ? a : b; }

/// The largest value of a parabola if that lies between its ends, otherwise the one half-way.
double peak_between(double begin, double half_way, double end) {
  const double bow = 2.0 * half_way - begin - end;
  const double rise = end - begin;
  const double peak = half_way + rise * rise / (8.0 * bow);
  return std::abs(rise) < 2.0 * bow ? peak : half_way;
}

// The loops over the nodes are functions of their own whose rows are declared not to overlap: only
// then are several nodes done at once.

void take_across(const NodeRow& __restrict along, std::size_t last, NodeRow& __restrict squares) {
  for (std::size_t i = kFirstNode; i < last; ++i) squares[i] -= along[i] * along[i];
}

void find_peaks(const NodeRow& __restrict at_node, const NodeRow& __restrict half_way,
                std::size_t last, NodeRow& __restrict peak) {
  for (std::size_t i = kFirstNode; i < last; ++i)
    peak[i] = peak_between(at_node[i], half_way[i], at_node[i + 1]);
}

/// Where the program bends by more than the tolerance between two nodes, it is an arc, whose quarters
/// are not known to this exactness: the one parabola is kept.
void find_peaks_closely(const NodeRow& __restrict at_node, const NodeRow& __restrict quarter,
                        const NodeRow& __restrict half_way,
                        const NodeRow& __restrict three_quarters, const NodeRow& __restrict bow,
                        const NodeRow& __restrict tolerance, std::size_t last,
                        NodeRow& __restrict peak) {
  for (std::size_t i = kFirstNode; i < last; ++i) {
    const double first = peak_between(at_node[i], quarter[i], half_way[i]);
    const double second = peak_between(half_way[i], three_quarters[i], at_node[i + 1]);
    const double both = larger(half_way[i], larger(first, second));
    peak[i] = bow[i] <= tolerance[i] ? both : peak[i];
  }
}

void find_largest(const NodeRow& __restrict at_node, const NodeRow& __restrict per_tolerance,
                  const NodeRow& __restrict peak, const NodeRow& __restrict span_tolerance,
                  std::size_t last, NodeRow& __restrict scratch, NodeRow& __restrict largest) {
  for (std::size_t i = kFirstNode; i < last; ++i) scratch[i] = peak[i] / span_tolerance[i];
  scratch[kFirstNode - 1] = scratch[last] = 0.0;
  for (std::size_t i = kFirstNode; i <= last; ++i) {
    const double beside = larger(scratch[i - 1], scratch[i]);
    const double off = larger(per_tolerance[i] * at_node[i], beside);
    largest[i] = per_tolerance[i] == 0.0 ? 0.0 : off;
  }
}

}  // namespace

void TubeDistance::prepare(const TubeNodes& nodes, std::size_t last) {
  const Stencils& e = nodes.position;
  const Stencils& d = nodes.bend;
  for (std::size_t i = kFirstNode; i <= last; ++i)
    per_tolerance_[i] = nodes.fixed[i] ? 0.0 : 1.0 / square(nodes.tolerance[i]);
  // ½ (q + q of the next node) − h²/16 (q'' + q'' of the next node); nothing behind the last node.
  for (std::size_t i = kFirstNode; i < last; ++i) {
    const double sag = square(nodes.step[i]) / 16.0;
    middle_.weight[0][i] = 0.5 * e.before[i] - sag * d.before[i];
    middle_.weight[1][i] = 0.5 * (e.at[i] + e.before[i + 1]) - sag * (d.at[i] + d.before[i + 1]);
    middle_.weight[2][i] = 0.5 * (e.behind[i] + e.at[i + 1]) - sag * (d.behind[i] + d.at[i + 1]);
    middle_.weight[3][i] = 0.5 * e.behind[i + 1] - sag * d.behind[i + 1];
    // A span that leads to a narrower tube is still in its own.
    span_tolerance_[i] = square(std::max(nodes.tolerance[i], nodes.tolerance[i + 1]));
  }
}

void TubeDistance::measure(const TubeNodes& nodes, std::size_t last) {
  at_node_.fill(0.0);
  half_way_ = {};
  for (std::size_t group = 0; group < off_.size(); ++group) {
    if (!nodes.moves_in(group)) continue;
    add_distances(nodes.position, middle_, nodes.group(group), last, off_[group], at_node_,
                  half_way_);
  }
  take_across(half_way_.along, last, half_way_.all);
  find_peaks(at_node_, half_way_.all, last, peak_);
  collect_largest(last);
}

void TubeDistance::look_closely(const TubeNodes& nodes, std::size_t last) {
  Squares quarter;
  Squares three_quarters;
  NodeRow bow{};
  for (std::size_t group = 0; group < off_.size(); ++group) {
    if (!nodes.moves_in(group)) continue;
    add_quarters(nodes, nodes.group(group), off_[group], last, quarter, three_quarters, bow);
  }
  take_across(quarter.along, last, quarter.all);
  take_across(three_quarters.along, last, three_quarters.all);
  find_peaks_closely(at_node_, quarter.all, half_way_.all, three_quarters.all, bow, span_tolerance_,
                     last, peak_);
  collect_largest(last);
}

void TubeDistance::collect_largest(std::size_t last) {
  NodeRow scratch;
  find_largest(at_node_, per_tolerance_, peak_, span_tolerance_, last, scratch, largest_);
}

/// Squares of the distances at the nodes and half-way to the next ones. Three axes together, and
/// added to what others came to.
void TubeDistance::add_distances(const Stencils& __restrict e, const MiddleStencils& __restrict m,
                                 const TubeNodes::AxisRows* __restrict axes, std::size_t last,
                                 GroupRows& __restrict off, NodeRow& __restrict at_node,
                                 Squares& __restrict half_way) {
  for (std::size_t i = kFirstNode; i <= last; ++i) {
    double at = at_node[i];
    double all = half_way.all[i];
    double along = half_way.along[i];
    for (std::size_t a = 0; a < kGroup; ++a) {
      const NodeRow& c = axes[a].control;
      const double q = e.before[i] * c[i - 1] + e.at[i] * c[i] + e.behind[i] * c[i + 1];
      const double from_point = q - axes[a].point[i];
      off[a][i] = from_point;
      at += from_point * from_point;
      const double middle = m.weight[0][i] * c[i - 1] + m.weight[1][i] * c[i] +
                            m.weight[2][i] * c[i + 1] + m.weight[3][i] * c[i + 2];
      const double aside = middle - axes[a].middle[i];
      all += aside * aside;
      along += aside * axes[a].middle_tangent[i];
    }
    at_node[i] = at;
    half_way.all[i] = all;
    half_way.along[i] = along;
  }
}

/// The same at a quarter and at three quarters of the way to the next node, and the square of how
/// far the program bends on it. A cubic there: from both ends' places and q''.
void TubeDistance::add_quarters(const TubeNodes& nodes, const TubeNodes::AxisRows* __restrict axes,
                                const GroupRows& __restrict off, std::size_t last,
                                Squares& __restrict quarter, Squares& __restrict three_quarters,
                                NodeRow& __restrict bow) {
  const Stencils& d = nodes.bend;
  for (std::size_t a = 0; a < kGroup; ++a) {
    const NodeRow& c = axes[a].control;
    const NodeRow& r = axes[a].point;
    const NodeRow& e = off[a];
    NodeRow bend;
    for (std::size_t i = kFirstNode; i <= last; ++i)
      bend[i] = d.before[i] * c[i - 1] + d.at[i] * c[i] + d.behind[i] * c[i + 1];
    for (std::size_t i = kFirstNode; i < last; ++i) {
      const double sag = square(nodes.step[i]) / 128.0;
      const double bends = axes[a].middle[i] - 0.5 * (r[i] + r[i + 1]);
      const double first =
          0.75 * e[i] + 0.25 * e[i + 1] - sag * (7.0 * bend[i] + 5.0 * bend[i + 1]) - 0.75 * bends;
      const double third =
          0.25 * e[i] + 0.75 * e[i + 1] - sag * (5.0 * bend[i] + 7.0 * bend[i + 1]) - 0.75 * bends;
      const double tangent = axes[a].middle_tangent[i];
      quarter.all[i] += first * first;
      quarter.along[i] += first * tangent;
      three_quarters.all[i] += third * third;
      three_quarters.along[i] += third * tangent;
      bow[i] += bends * bends;
    }
  }
}

}  // namespace cnc::motion
