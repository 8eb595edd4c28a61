#include "motion/tube_spline.h"

#include <algorithm>
#include <utility>

namespace cnc::motion {

namespace {

/// The path behind the last committed node has to be in the tube as well, or the commitment would
/// head out of it.
constexpr std::size_t kCheckedBehind = 12;

}  // namespace

TubeSpline::TubeSpline(double least_stiffness) : least_stiffness_(least_stiffness) {}

// --- the run -------------------------------------------------------------------------------------

void TubeSpline::clear() {
  nodes_.clear();
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
  nodes_.count = 0;
  for (std::size_t i = 0; i <= kFirstNode; ++i) nodes_.push(point, tolerance);
  nodes_.fixed[kFirstNode] = true;
  free_ = kFirstNode - 1;
  completed_ = kFirstNode - 1;
}

void TubeSpline::add(const TubeSpan& span) {
  const std::size_t last = nodes_.count - 1;
  nodes_.step[last] = span.length;
  for (const Axis axis : kAllAxes) {
    nodes_.axes[axis].middle[last] = span.middle[axis];
    nodes_.axes[axis].middle_tangent[last] = span.middle_tangent[axis];
    if (span.middle_tangent[axis] != 0.0) nodes_.moves[axis] = true;
  }
  nodes_.push(span.end, span.end_tolerance);
  ++pending_;
  // Two more nodes than the window has: their knots enter its last stencil.
  if (last + 1 >= first_row() + kTubeWindow + 1) {
    solve_window(first_row() + kTubeWindow - 1, first_row() + kTubeCommit - 1, false);
  }
}

void TubeSpline::finish() {
  if (pending_ == 0) return;
  const std::size_t last = nodes_.count - 1;
  close();
  solve_window(last, last, true);
}

/// Two ghosts behind the last node, with the last two knots mirrored.
void TubeSpline::close() {
  const std::size_t last = nodes_.count - 1;
  const std::size_t before = last > kFirstNode + 1 ? last - 2 : last - 1;
  nodes_.fixed[last] = true;
  nodes_.step[last] = nodes_.step[last - 1];
  nodes_.push({}, 1.0);
  nodes_.step[last + 1] = nodes_.step[before];
  nodes_.push({}, 1.0);
}

void TubeSpline::pop() {
  if (++taken_ < ready_.size()) return;
  ready_.clear();
  taken_ = 0;
}

std::size_t TubeSpline::first_row() const { return std::max(kFirstNode, free_ - 1); }

// --- first guess ---------------------------------------------------------------------------------

/// Where the program would be at the control point's place on the knots: straight lines come out as
/// they went in.
void TubeSpline::place_control(std::size_t i) {
  const NodeRow& step = nodes_.step;
  std::size_t anchor = i;
  double offset = (step[i] - step[i - 1]) / 3.0;
  if (i < kFirstNode) {
    anchor = kFirstNode;
    offset -= step[i];
  }
  const bool beyond_end = nodes_.fixed[i - 1] && i - 1 > kFirstNode;
  if (beyond_end) {
    anchor = i - 1;
    offset += step[i - 1];
  }
  const std::size_t from =
      beyond_end || (offset < 0.0 && anchor > kFirstNode) ? anchor - 1 : anchor;
  const double part = offset / step[from];
  for (TubeNodes::AxisRows& axis : nodes_.axes.values) {
    const NodeRow& point = axis.point;
    axis.control[i] = point[anchor] + part * (point[from + 1] - point[from]);
  }
}

/// Fills in stencils up to node `last` and the control points up to the one behind it.
void TubeSpline::complete(std::size_t last) {
  if (completed_ < kFirstNode) {
    nodes_.step[1] = nodes_.step[kFirstNode];
    nodes_.step[0] = nodes_.step[kFirstNode + 1];
    place_control(1);
    completed_ = kFirstNode;
  }
  for (; completed_ <= last; ++completed_) {
    nodes_.complete(completed_, least_stiffness_);
    place_control(completed_);
  }
  // Its node's stencils may still be unknown; it is placed again when they are.
  place_control(last + 1);
}

// --- one window ----------------------------------------------------------------------------------

void TubeSpline::solve_window(std::size_t last_node, std::size_t commit, bool run_ends) {
  complete(last_node);
  const std::size_t checked = run_ends ? last_node : std::min(last_node, commit + kCheckedBehind);
  if (!relaxation_.relax(nodes_, free_, last_node, checked)) {
    std::size_t offender = first_row();
    while (offender < last_node && !relaxation_.is_outside(offender)) ++offender;
    // The control points around the end must still be free.
    const std::size_t end = std::max(offender, free_ + 1);
    if (end < last_node) return break_run(end, last_node, run_ends);
  }
  if (nodes_.fixed[kFirstNode]) meet_start();
  if (run_ends) meet_end(last_node);
  emit(commit, run_ends);
  if (run_ends) {
    nodes_.count = 0;
    return;
  }
  free_ = commit + 2;
  drop_before(commit - kFirstNode);
}

/// Where no curve stays in the tube at speed, the machine stops: the run ends at `node`, exactly,
/// and another begins there.
void TubeSpline::break_run(std::size_t node, std::size_t last_node, bool run_ends) {
  const std::size_t end = run_ends ? last_node : nodes_.count - 1;
  const auto at = [this](NodeRow TubeNodes::AxisRows::*row, std::size_t i) {
    Position position;
    for (const Axis axis : kAllAxes) position[axis] = (nodes_.axes[axis].*row)[i];
    return position;
  };
  std::vector<TubeSpan> rest;
  for (std::size_t i = node; i < end; ++i) {
    rest.push_back({.length = nodes_.step[i],
                    .middle = at(&TubeNodes::AxisRows::middle, i),
                    .middle_tangent = at(&TubeNodes::AxisRows::middle_tangent, i),
                    .end = at(&TubeNodes::AxisRows::point, i + 1),
                    .end_tolerance = nodes_.tolerance[i + 1]});
  }
  const Position corner = at(&TubeNodes::AxisRows::point, node);
  const double tolerance = nodes_.tolerance[node];
  nodes_.count = node + 1;
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
  const Stencils& e = nodes_.position;
  const std::size_t i = kFirstNode;
  for (TubeNodes::AxisRows& axis : nodes_.axes.values) {
    NodeRow& c = axis.control;
    c[i - 1] = (axis.point[i] - e.at[i] * c[i] - e.behind[i] * c[i + 1]) / e.before[i];
  }
}

void TubeSpline::meet_end(std::size_t last_node) {
  const Stencils& e = nodes_.position;
  const std::size_t i = last_node;
  for (TubeNodes::AxisRows& axis : nodes_.axes.values) {
    NodeRow& c = axis.control;
    c[i + 1] = (axis.point[i] - e.before[i] * c[i - 1] - e.at[i] * c[i]) / e.behind[i];
  }
}

/// Spans from the first node to `last_node` are final. Axes that do not move stay where they are
/// to the last digit. A run of one span has no node that could bend it: it bends as the program.
void TubeSpline::emit(std::size_t last_node, bool stop) {
  Position place;
  Position q2;
  const auto look_at = [&](std::size_t i) {
    for (const Axis axis : kAllAxes) {
      const bool moves = nodes_.moves[axis];
      place[axis] = moves && !nodes_.fixed[i] ? nodes_.combine(nodes_.position, axis, i)
                                              : nodes_.axes[axis].point[i];
      q2[axis] = moves ? nodes_.combine(nodes_.bend, axis, i) : 0.0;
    }
  };
  look_at(kFirstNode);
  const bool is_single = stop && nodes_.fixed[kFirstNode] && last_node == kFirstNode + 1;
  for (std::size_t i = kFirstNode; i < last_node; ++i) {
    const Position start = place;
    Position start_q2 = q2;
    look_at(i + 1);
    const double h = nodes_.step[i];
    if (is_single) start_q2 = q2 = bend_of_program();
    const double per_step = 1.0 / h;
    const Position c1 = (place - start) * per_step - (h / 6.0) * (2.0 * start_q2 + q2);
    const Position c3 = (q2 - start_q2) * (per_step / 6.0);
    ready_.push_back({Cubic(start, c1, 0.5 * start_q2, c3, place, h), stop && i + 1 == last_node});
    --pending_;
  }
}

/// q'' of the parabola through the program's places at both ends of the first span and half-way.
Position TubeSpline::bend_of_program() const {
  Position bend;
  const std::size_t i = kFirstNode;
  for (const Axis axis : kAllAxes) {
    const TubeNodes::AxisRows& rows = nodes_.axes[axis];
    const double bow = rows.middle[i] - 0.5 * (rows.point[i] + rows.point[i + 1]);
    bend[axis] = nodes_.moves[axis] ? -8.0 * bow / (nodes_.step[i] * nodes_.step[i]) : 0.0;
  }
  return bend;
}

void TubeSpline::drop_before(std::size_t i) {
  nodes_.drop_before(i);
  free_ -= i;
  completed_ -= i;
}

}  // namespace cnc::motion
