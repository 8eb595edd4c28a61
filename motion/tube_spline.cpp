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

/// λ in units of λ* at the beginning.
constexpr double kFirstStiffness = 0.1;

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
