#include "motion/tube_spline.h"

#include <algorithm>
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

std::size_t lane_of(Axis axis) { return index_of(axis) % 4; }
std::size_t group_of(Axis axis) { return index_of(axis) / 4; }

}  // namespace

TubeSpline::TubeSpline(double least_stiffness) : least_stiffness_(least_stiffness) {}

std::array<std::vector<Lanes>*, 4> TubeSpline::kept(Group& group) {
  return {&group.point, &group.control, &group.middle, &group.middle_tangent};
}

// --- the run -------------------------------------------------------------------------------------

void TubeSpline::clear() {
  nodes_.clear();
  for (Group& group : groups_) {
    for (auto* lanes : kept(group)) lanes->clear();
    group.moves = false;
  }
  moves_ = {};
  ready_.clear();
  taken_ = 0;
  pending_ = 0;
}

void TubeSpline::begin(const Position& start, double tolerance) {
  clear();
  this->start(start, tolerance);
}

/// What came of an earlier part of the run stays ready.
void TubeSpline::start(const Position& point, double tolerance) {
  nodes_.clear();
  for (Group& group : groups_) {
    for (auto* lanes : kept(group)) lanes->clear();
  }
  for (std::size_t i = 0; i <= kFirst; ++i) push_node(point, tolerance);
  nodes_[kFirst].fixed = true;
  free_ = kFirst - 1;
  emitted_ = kFirst;
  completed_ = kFirst - 1;
}

Lanes TubeSpline::lanes_of(const Position& position, std::size_t group) {
  Lanes lanes;
  for (const Axis axis : kAllAxes) {
    if (group_of(axis) == group) lanes.lane[lane_of(axis)] = position[axis];
  }
  return lanes;
}

Position TubeSpline::position_of(std::vector<Lanes> Group::*lanes, std::size_t i) const {
  Position position;
  for (const Axis axis : kAllAxes) {
    position[axis] = (groups_[group_of(axis)].*lanes)[i].lane[lane_of(axis)];
  }
  return position;
}

void TubeSpline::push_node(const Position& point, double tolerance) {
  nodes_.push_back({.tolerance = tolerance});
  for (std::size_t g = 0; g < kGroups; ++g) {
    groups_[g].point.push_back(lanes_of(point, g));
    groups_[g].control.push_back(groups_[g].point.back());
    groups_[g].middle.emplace_back();
    groups_[g].middle_tangent.emplace_back();
  }
}

void TubeSpline::add(const TubeSpan& span) {
  const std::size_t last = nodes_.size() - 1;
  nodes_[last].step = span.length;
  for (std::size_t g = 0; g < kGroups; ++g) {
    Group& group = groups_[g];
    group.middle[last] = lanes_of(span.middle, g);
    group.middle_tangent[last] = lanes_of(span.middle_tangent, g);
  }
  for (const Axis axis : kAllAxes) {
    if (span.middle_tangent[axis] == 0.0) continue;
    moves_[axis] = true;
    groups_[group_of(axis)].moves = true;
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
  close();
  solve_window(last, last, true);
}

/// Two ghosts behind the last node, with the last two knots mirrored.
void TubeSpline::close() {
  const std::size_t last = nodes_.size() - 1;
  const std::size_t before = last > kFirst + 1 ? last - 2 : last - 1;
  nodes_[last].fixed = true;
  nodes_[last].step = nodes_[last - 1].step;
  push_node({}, 1.0);
  nodes_[last + 1].step = nodes_[before].step;
  push_node({}, 1.0);
}

void TubeSpline::pop() {
  if (++taken_ < ready_.size()) return;
  ready_.clear();
  taken_ = 0;
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
  for (Group& group : groups_) {
    group.control[i] = group.point[anchor] + part * (group.point[from + 1] - group.point[from]);
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
  const std::size_t checked =
      run_ends ? last_node : std::min(last_node, commit + kChecked - kCommit);
  if (!relax(last_node, checked)) {
    std::size_t offender = first_row();
    while (nodes_[offender].fixed || nodes_[offender].ratio <= 1.0) ++offender;
    // The control points around the end must still be free.
    const std::size_t end = std::max(offender, free_ + 1);
    if (end < last_node) return break_run(end, last_node, run_ends);
  }
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

/// Where no curve stays in the tube at speed, the machine stops: the run ends at `node`, exactly,
/// and another begins there.
void TubeSpline::break_run(std::size_t node, std::size_t last_node, bool run_ends) {
  const std::size_t end = run_ends ? last_node : nodes_.size() - 1;
  std::vector<TubeSpan> rest;
  for (std::size_t i = node; i < end; ++i) {
    rest.push_back({.length = nodes_[i].step,
                    .middle = position_of(&Group::middle, i),
                    .middle_tangent = position_of(&Group::middle_tangent, i),
                    .end = position_of(&Group::point, i + 1),
                    .end_tolerance = nodes_[i + 1].tolerance});
  }
  const Position corner = position_of(&Group::point, node);
  const double tolerance = nodes_[node].tolerance;
  nodes_.resize(node + 1);
  for (Group& group : groups_) {
    for (auto* lanes : kept(group)) lanes->resize(node + 1);
  }
  completed_ = std::min(completed_, node - 1);
  close();
  solve_window(node, node, true);

  pending_ -= rest.size();
  start(corner, tolerance);
  for (const TubeSpan& span : rest) add(span);
  if (run_ends) finish();
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

/// The outermost control points move so that the run's ends are met exactly.
void TubeSpline::meet_start() {
  const Stencil& e = nodes_[kFirst].position;
  for (Group& group : groups_) {
    auto& c = group.control;
    c[kFirst - 1] =
        (1.0 / e.before) * (group.point[kFirst] - e.at * c[kFirst] - e.behind * c[kFirst + 1]);
  }
}

void TubeSpline::meet_end(std::size_t last_node) {
  const Stencil& e = nodes_[last_node].position;
  for (Group& group : groups_) {
    auto& c = group.control;
    c[last_node + 1] = (1.0 / e.behind) *
                       (group.point[last_node] - e.before * c[last_node - 1] - e.at * c[last_node]);
  }
}

/// A stencil applied to the control points around node i; for axes that stand, what `standing`
/// says.
Position TubeSpline::combine(const Stencil& stencil, std::size_t i,
                             const Position& standing) const {
  std::array<Lanes, kGroups> sums;
  for (std::size_t g = 0; g < kGroups; ++g) {
    const Lanes* c = groups_[g].control.data() + i;
    if (groups_[g].moves) {
      sums[g] = stencil.before * c[-1] + stencil.at * c[0] + stencil.behind * c[1];
    }
  }
  Position result = standing;
  for (const Axis axis : kAllAxes) {
    if (moves_[axis]) result[axis] = sums[group_of(axis)].lane[lane_of(axis)];
  }
  return result;
}

void TubeSpline::emit(std::size_t last_node, bool stop) {
  const auto place = [this](std::size_t i) {
    const Position programmed = position_of(&Group::point, i);
    return nodes_[i].fixed ? programmed : combine(nodes_[i].position, i, programmed);
  };
  Position start = place(emitted_);
  Position q2 = combine(nodes_[emitted_].bend, emitted_, {});
  for (; emitted_ < last_node; ++emitted_) {
    const double h = nodes_[emitted_].step;
    const Position end = place(emitted_ + 1);
    const Position next_q2 = combine(nodes_[emitted_ + 1].bend, emitted_ + 1, {});
    const Position c1 = (end - start) * (1.0 / h) - (h / 6.0) * (2.0 * q2 + next_q2);
    const Position c3 = (next_q2 - q2) * (1.0 / (6.0 * h));
    ready_.push_back({Cubic(start, c1, 0.5 * q2, c3, end, h), stop && emitted_ + 1 == last_node});
    --pending_;
    start = end;
    q2 = next_q2;
  }
}

void TubeSpline::drop_before(std::size_t i) {
  const auto drop = [i](auto& rows) {
    rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(i));
  };
  drop(nodes_);
  for (Group& group : groups_) {
    for (auto* lanes : kept(group)) drop(*lanes);
  }
  free_ -= i;
  emitted_ -= i;
  completed_ -= i;
}

}  // namespace cnc::motion
