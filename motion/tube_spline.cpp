#include "motion/tube_spline.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace cnc::motion {

namespace {

/// Nodes solved at once, and how many of them become final. Other sizes (40/20 … 400/200) change
/// the time of a job by 0.2 %.
constexpr std::size_t kWindow = 100;
constexpr std::size_t kCommit = 75;
/// The path behind the last committed node has to be in the tube as well, or the commitment would
/// head out of it.
constexpr std::size_t kChecked = kCommit + 12;

/// The iteration aims at this part of the tolerance at the nodes and accepts the other; what is
/// left is for the path between them.
constexpr double kTarget = 0.91;
constexpr double kAccepted = 0.96;

constexpr int kRounds = 4;        // then only what leaves the tube is stiffened
constexpr int kExtraRounds = 30;  // then the run is broken

/// λ in units of λ*: at the beginning, and its largest value. An unsatisfiable node would drive it
/// up without end.
constexpr double kFirstStiffness = 0.1;
constexpr double kLargestStiffness = 1e5;

/// λ at the ends of a run in units of W⁻³, the size of the bending's own entries in the matrix.
constexpr double kEndStiffness = 1e5;

/// The first node of a run; two ghosts stand before it.
constexpr std::size_t kFirst = 2;

double square(double value) { return value * value; }

}  // namespace

TubeSpline::TubeSpline(double least_stiffness) : least_stiffness_(least_stiffness) {}

// --- the run -------------------------------------------------------------------------------------

void TubeSpline::clear() {
  nodes_.clear();
  for (const Axis axis : kAllAxes) {
    for (AxisArray<Row>* rows : {&point_, &control_, &middle_, &middle_tangent_}) {
      (*rows)[axis].clear();
    }
  }
  axes_.clear();
  ready_.clear();
  taken_ = 0;
  pending_ = 0;
}

void TubeSpline::begin(const Position& start, double tolerance) {
  clear();
  for (std::size_t i = 0; i < kFirst; ++i) push_node(start, tolerance);
  push_node(start, tolerance);
  nodes_[kFirst].fixed = true;
  free_ = kFirst - 1;
  emitted_ = kFirst;
  completed_ = kFirst - 1;
}

void TubeSpline::push_node(const Position& point, double tolerance) {
  nodes_.push_back({.tolerance = tolerance});
  for (const Axis axis : kAllAxes) {
    point_[axis].push_back(point[axis]);
    control_[axis].push_back(point[axis]);
    middle_[axis].push_back(0.0);
    middle_tangent_[axis].push_back(0.0);
  }
}

void TubeSpline::add(const TubeSpan& span) {
  const std::size_t last = nodes_.size() - 1;
  nodes_[last].step = span.length;
  for (const Axis axis : kAllAxes) {
    middle_[axis][last] = span.middle[axis];
    middle_tangent_[axis][last] = span.middle_tangent[axis];
    const bool moves = span.end[axis] != point_[axis][last] || span.middle_tangent[axis] != 0.0;
    if (moves && std::find(axes_.begin(), axes_.end(), axis) == axes_.end()) axes_.push_back(axis);
  }
  push_node(span.end, span.end_tolerance);
  ++pending_;
  // Two more nodes than the window has: their knots enter its last stencil.
  if (last + 1 >= first_row() + kWindow + 1) {
    solve_window(first_row() + kWindow - 1, first_row() + kCommit - 1, false);
  }
}

void TubeSpline::finish() {
  if (pending_ == 0) return;
  const std::size_t last = nodes_.size() - 1;
  assert(last >= kFirst + 2);
  nodes_[last].fixed = true;
  // Two ghosts behind the end, with the last two knots mirrored.
  nodes_[last].step = nodes_[last - 1].step;
  push_node({}, 1.0);
  nodes_[last + 1].step = nodes_[last - 2].step;
  push_node({}, 1.0);
  solve_window(last, last, true);
}

TubeSpline::Ready TubeSpline::take() {
  Ready result = std::move(ready_[taken_++]);
  if (taken_ == ready_.size()) {
    ready_.clear();
    taken_ = 0;
  }
  return result;
}

std::size_t TubeSpline::first_row() const { return std::max(kFirst, free_ - 1); }

// --- stencils and first guess --------------------------------------------------------------------

void TubeSpline::set_stencils(std::size_t i) {
  const double h0 = nodes_[i - 2].step;
  const double h1 = nodes_[i - 1].step;
  const double h2 = nodes_[i].step;
  const double h3 = nodes_[i + 1].step;
  Node& node = nodes_[i];
  node.weight = 0.5 * (h1 + h2);
  const double before = square(h2) / ((h0 + h1 + h2) * (h1 + h2));
  const double behind = square(h1) / ((h1 + h2 + h3) * (h1 + h2));
  node.position = {before, 1.0 - before - behind, behind};
  const double bend_before = 6.0 / ((h1 + h2) * (h0 + h1 + h2));
  const double bend_behind = 6.0 / ((h1 + h2) * (h1 + h2 + h3));
  node.bend = {bend_before, -bend_before - bend_behind, bend_behind};
  node.natural = node.weight / square(square(std::max(node.weight, 2.0 * node.tolerance)));
  node.stiffness = node.fixed ? kEndStiffness / (node.weight * node.weight * node.weight)
                              : kFirstStiffness * node.natural;
}

/// Where the program would be at the control point's place on the knots: straight lines come out as
/// they went in.
void TubeSpline::place_control(std::size_t i) {
  std::size_t anchor = i;
  double offset = (nodes_[i].step - nodes_[i - 1].step) / 3.0;
  if (i < kFirst) {
    anchor = kFirst;
    offset -= nodes_[i].step;
  }
  const bool beyond_end = nodes_[i - 1].fixed && i - 1 > kFirst;
  if (beyond_end) {
    anchor = i - 1;
    offset += nodes_[i - 1].step;
  }
  const std::size_t from = beyond_end || (offset < 0.0 && anchor > kFirst) ? anchor - 1 : anchor;
  const double part = offset / nodes_[from].step;
  for (const Axis axis : axes_) {
    const Row& point = point_[axis];
    control_[axis][i] = point[anchor] + part * (point[from + 1] - point[from]);
  }
}

/// Fills in stencils up to node `last` and the control points up to the one behind it.
void TubeSpline::complete(std::size_t last) {
  if (completed_ < kFirst) {
    nodes_[1].step = nodes_[kFirst].step;
    nodes_[0].step = nodes_[kFirst + 1].step;
    place_control(1);
    completed_ = kFirst;
  }
  for (; completed_ <= last; ++completed_) {
    set_stencils(completed_);
    place_control(completed_);
  }
  // Its node's stencils may still be unknown; it is placed again when they are.
  place_control(last + 1);
}

// --- one window ----------------------------------------------------------------------------------

void TubeSpline::solve_window(std::size_t last_node, std::size_t commit, bool run_ends) {
  complete(last_node);
  (void)relax(last_node, run_ends ? last_node : std::min(last_node, commit + kChecked - kCommit));
  if (emitted_ == kFirst && nodes_[kFirst].fixed) meet_start();
  if (run_ends) meet_end(last_node);
  emit(commit, run_ends);
  if (run_ends) {
    nodes_.clear();
    return;
  }
  free_ = commit + 2;
  drop_before(commit - kFirst);
}

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

double TubeSpline::position_at(std::size_t axis, std::size_t i) const {
  const Stencil& s = nodes_[i].position;
  const double* c = control_.values[axis].data() + i;
  return s.before * c[-1] + s.at * c[0] + s.behind * c[1];
}

double TubeSpline::bend_at(std::size_t axis, std::size_t i) const {
  const Stencil& s = nodes_[i].bend;
  const double* c = control_.values[axis].data() + i;
  return s.before * c[-1] + s.at * c[0] + s.behind * c[1];
}

/// Distances from the program at the nodes, and half-way between them: the middle of a span counts
/// for both its nodes, across the program's direction only.
void TubeSpline::measure(std::size_t last_node) {
  const std::size_t size = nodes_.size();
  const std::size_t begin = emitted_;
  Row& at_node = diagonal_;
  Row& across = beside_;
  Row& along = beyond_;
  at_node.assign(size, 0.0);
  across.assign(size, 0.0);
  along.assign(size, 0.0);
  for (const Axis axis : axes_) {
    const std::size_t a = index_of(axis);
    Row& q = q_[axis];
    Row& q2 = q2_[axis];
    q.resize(size);
    q2.resize(size);
    for (std::size_t i = begin; i <= last_node; ++i) {
      q[i] = position_at(a, i);
      q2[i] = bend_at(a, i);
      at_node[i] += square(q[i] - point_[axis][i]);
    }
    for (std::size_t i = begin; i < last_node; ++i) {
      const double h = nodes_[i].step;
      const double off =
          0.5 * (q[i] + q[i + 1]) - h * h / 16.0 * (q2[i] + q2[i + 1]) - middle_[axis][i];
      across[i] += square(off);
      along[i] += off * middle_tangent_[axis][i];
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
  const std::size_t end = last_node + 2;
  factorise(free_, end);
  for (const Axis axis : axes_) {
    Row& x = gradient_[axis];
    for (std::size_t j = free_; j < end; ++j) {
      if (j > free_) x[j] -= beside_[j - 1] * x[j - 1];
      if (j > free_ + 1) x[j] -= beyond_[j - 2] * x[j - 2];
    }
    for (std::size_t j = end; j-- > free_;) {
      x[j] *= diagonal_[j];
      if (j + 1 < end) x[j] -= beside_[j] * x[j + 1];
      if (j + 2 < end) x[j] -= beyond_[j] * x[j + 2];
      control_[axis][j] += x[j];
    }
  }
}

/// The matrix DᵀWD + EᵀΛE and the negative gradient, over all control points that the rows touch.
void TubeSpline::assemble(std::size_t last_node) {
  const std::size_t size = nodes_.size();
  for (Row* row : {&diagonal_, &beside_, &beyond_}) row->assign(size, 0.0);
  for (const Axis axis : axes_) gradient_[axis].assign(size, 0.0);
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
    for (const Axis axis : axes_) {
      const double bend = w * q2_[axis][i];
      const double off = l * (q_[axis][i] - point_[axis][i]);
      double* gradient = gradient_[axis].data() + i;
      gradient[-1] -= d.before * bend + e.before * off;
      gradient[0] -= d.at * bend + e.at * off;
      gradient[1] -= d.behind * bend + e.behind * off;
    }
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

/// The outermost control points move so that the run's ends are met exactly.
void TubeSpline::meet_start() {
  const Stencil& e = nodes_[kFirst].position;
  for (const Axis axis : axes_) {
    Row& c = control_[axis];
    c[kFirst - 1] = (point_[axis][kFirst] - e.at * c[kFirst] - e.behind * c[kFirst + 1]) / e.before;
  }
}

void TubeSpline::meet_end(std::size_t last_node) {
  const Stencil& e = nodes_[last_node].position;
  for (const Axis axis : axes_) {
    Row& c = control_[axis];
    c[last_node + 1] =
        (point_[axis][last_node] - e.before * c[last_node - 1] - e.at * c[last_node]) / e.behind;
  }
}

void TubeSpline::emit(std::size_t last_node, bool stop) {
  for (; emitted_ < last_node; ++emitted_) {
    const std::size_t i = emitted_;
    const double h = nodes_[i].step;
    Position start;
    Position c1;
    Position c2;
    Position c3;
    Position end;
    for (const Axis axis : kAllAxes) start[axis] = end[axis] = point_[axis][i];
    for (const Axis axis : axes_) {
      const std::size_t a = index_of(axis);
      const double q2 = bend_at(a, i);
      const double next_q2 = bend_at(a, i + 1);
      start[axis] = nodes_[i].fixed ? point_[axis][i] : position_at(a, i);
      end[axis] = nodes_[i + 1].fixed ? point_[axis][i + 1] : position_at(a, i + 1);
      c1[axis] = (end[axis] - start[axis]) / h - h * (2.0 * q2 + next_q2) / 6.0;
      c2[axis] = 0.5 * q2;
      c3[axis] = (next_q2 - q2) / (6.0 * h);
    }
    ready_.push_back({Cubic(start, c1, c2, c3, end, h), stop && i + 1 == last_node});
    --pending_;
  }
}

void TubeSpline::drop_before(std::size_t i) {
  const auto drop = [i](auto& rows) {
    rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(i));
  };
  drop(nodes_);
  for (const Axis axis : kAllAxes) {
    for (AxisArray<Row>* rows : {&point_, &control_, &middle_, &middle_tangent_}) {
      drop((*rows)[axis]);
    }
  }
  free_ -= i;
  emitted_ -= i;
  completed_ -= i;
}

}  // namespace cnc::motion
