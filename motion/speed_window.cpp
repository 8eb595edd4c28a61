#include "motion/speed_window.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/barrier.h"

namespace cnc::motion {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Schedule of the rounds, found by trial: a faster one leaves more limits broken after the same
/// number of rounds, a slower one needs more. The least weight is what the plan gives away, about,
/// as a part of its time.
constexpr double kFirstWeight = 0.02;
constexpr double kLeastWeight = 0.001;
constexpr double kWeightDecay = 0.7;
constexpr double kFirstLeast = 0.05;
constexpr double kLeastLeast = 0.001;
constexpr double kLeastDecay = 0.7;

/// The barriers weigh as much as the time of their cell, but no less than this, s: limits of a tiny
/// cell are not to be broken because that costs little.
constexpr double kLeastTime = 5e-4;

/// Weight of the limits of speed beside those of acceleration and jerk: they are simple enough to
/// be approached closely at once.
constexpr double kSpeedShare = 0.1;

/// The weights fall after a round that went at least this part of its step.
constexpr double kPartThatCounts = 0.2;
/// Per round for a cell that still breaks a limit after them.
constexpr double kHarder = 1.2;

constexpr int kMostHalvings = 12;
/// Part of the gain promised by the gradient that a step must bring.
constexpr double kPartOfPromise = 0.1;
/// A promise that is this part of the whole is not worth a round.
constexpr double kNothingToGain = 1e-6;

using Three = std::array<double, 3>;

}  // namespace

double SpeedWindow::Goal::cost(const CellX& x, double third) const {
  const HardBarrier hard{kSpeedShare * defence.least};
  const SoftBarrier soft{wish_least};
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += third / std::sqrt(x[i]) + most_weight[i] * hard.value(1.0 - x[i] / most[i]);
    if (wish_weight > 0.0) sum += wish_weight * soft.value(1.0 - x[i] / wanted_x);
  }
  return sum;
}

void SpeedWindow::Goal::add_cost(const CellX& x, double third, CellModel& model) const {
  // Time of the cell, from above: the integral of 1/√x is at most length · mean of 1/√coefficient.
  constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
  for (std::size_t i = 0; i < 3; ++i) {
    const Barrier hard = HardBarrier{kSpeedShare * defence.least}.at(1.0 - x[i] / most[i]);
    const Barrier soft = SoftBarrier{wish_least}.at(1.0 - x[i] / wanted_x);
    const double time = third / (x[i] * std::sqrt(x[i]));
    model.gradient[i] -=
        0.5 * time + most_weight[i] * hard.slope / most[i] + wish_weight * soft.slope / wanted_x;
    model.curvature[kDiagonal[i]] += 0.75 * time / x[i] +
                                     most_weight[i] * hard.bend / (most[i] * most[i]) +
                                     wish_weight * soft.bend / (wanted_x * wanted_x);
  }
}

SpeedWindow::SpeedWindow(std::size_t max_cells)
    : cells(max_cells), goals_(cells.free()), gradient_(cells.free()), step_(cells.free()) {
  for (auto& diagonal : diagonal_) diagonal.resize(cells.free());
}

CellX SpeedWindow::x_of(std::uint64_t index) const { return moved_x(index, cells.end(), 0.0); }

CellX SpeedWindow::moved_x(std::uint64_t index, std::uint64_t first, double part) const {
  const auto middle = [&](std::uint64_t i) {
    return i >= first ? cells[i].x + part * step_[i - first] : cells[i].x;
  };
  const double own = middle(index);
  const Knot& begin = cells[index].knot;
  const bool is_last = index + 1 == cells.end();
  const Knot& finish = is_last ? end.knot : cells[index + 1].knot;
  const double before = begin.before == 0.0 ? 0.0 : begin.before * middle(index - 1);
  const double behind = is_last ? 0.0 : finish.behind * middle(index + 1);
  return {before + begin.behind * own + begin.given, own,
          finish.before * own + behind + finish.given};
}

void SpeedWindow::reset_weights(std::uint64_t first) {
  for (std::uint64_t i = first_touched(first); i != cells.end(); ++i) {
    cells[i].weight = kFirstWeight;
    cells[i].least = kFirstLeast;
  }
}

void SpeedWindow::defend_harder(std::uint64_t first) {
  for (std::uint64_t i = first_touched(first); i != cells.end(); ++i) {
    if (usage_of(i) <= kUsageOfPlan) continue;
    cells[i].weight = std::min(kFirstWeight, kHarder * cells[i].weight);
    cells[i].least /= kHarder;
  }
}

double SpeedWindow::most_speed_x(std::uint64_t index) const {
  const PlannedCell& planned = cells[index];
  const double machine = planned.cell.machine_x;
  return planned.feed_is_kept ? std::min(machine, planned.wanted_x) : machine;
}

std::array<double, 3> SpeedWindow::most_x(std::uint64_t index) const {
  const double most = most_speed_x(index);
  return {index == begin_cell ? std::min(most, most_start_x) : most, most,
          index + 1 == cells.end() ? std::min(most, end.most_x) : most};
}

SpeedWindow::Goal SpeedWindow::goal_of(std::uint64_t index) const {
  const PlannedCell& planned = cells[index];
  const double root = std::sqrt(planned.x);
  const double time =
      std::max(planned.cell.length / root, kLeastTime * planned.weight / kFirstWeight);
  Goal goal{};
  goal.defence = {planned.weight * time, planned.least, root};
  goal.wanted_x = planned.wanted_x;
  goal.wish_weight = planned.feed_is_kept ? 0.0 : kSpeedShare * goal.defence.weight;
  // Above the feed, x costs twice what it gains in time (a third of ½ time/x per coefficient): the
  // wish to be slower is as strong there as the wish for time elsewhere.
  goal.wish_least =
      3.0 * kSpeedShare * planned.weight * std::max(1.0, planned.x / planned.wanted_x);
  goal.most = most_x(index);
  // Beside a standstill it is the jerk that limits x.
  for (std::size_t i = 0; i < 3; ++i) {
    const bool is_speed = goal.most[i] == goal.most[1];
    goal.most_weight[i] = (is_speed ? kSpeedShare : 1.0) * goal.defence.weight;
  }
  return goal;
}

double SpeedWindow::usage_of(std::uint64_t index) const {
  const CellX x = x_of(index);
  const Three most = most_x(index);
  double used = motion::usage_of(cells[index].cell, x);
  for (std::size_t i = 0; i < 3; ++i) used = larger(used, x[i] / most[i]);
  return used;
}

Usage SpeedWindow::worst(std::uint64_t first) const {
  Usage worst{0.0, first};
  for (std::uint64_t i = first_touched(first); i != cells.end(); ++i) {
    const double used = usage_of(i);
    if (used > worst.part || std::isnan(used)) worst = {used, i};
  }
  return worst;
}

/// The cell before the first free one feels its coefficient too.
std::uint64_t SpeedWindow::first_touched(std::uint64_t first) const {
  return first > begin_cell ? first - 1 : first;
}

void SpeedWindow::assemble(std::uint64_t first) {
  const auto size = static_cast<std::ptrdiff_t>(cells.end() - first);
  std::fill_n(gradient_.begin(), size, 0.0);
  for (auto& diagonal : diagonal_) std::fill_n(diagonal.begin(), size, 0.0);
  const std::uint64_t touched = first_touched(first);
  for (std::uint64_t i = touched; i != cells.end(); ++i) {
    const Goal& goal = goals_[i - touched];
    const CellX x = x_of(i);
    CellModel model;
    add_barrier(cells[i].cell, x, goal.defence, model);
    goal.add_cost(x, cells[i].cell.length / 3.0, model);
    add_to_system(i, first, model);
  }
}

/// From the three coefficients of a cell to the middle ones of its neighbours and itself.
void SpeedWindow::add_to_system(std::uint64_t index, std::uint64_t first, const CellModel& model) {
  const bool is_last = index + 1 == cells.end();
  const Knot& left = cells[index].knot;
  const Knot& right = is_last ? end.knot : cells[index + 1].knot;
  const Three before{left.before, 0.0, 0.0};
  const Three own{left.behind, 1.0, right.before};
  const Three behind{0.0, 0.0, is_last ? 0.0 : right.behind};
  const std::array<const Three*, 3> columns{&before, &own, &behind};
  const auto& [c00, c01, c02, c11, c12, c22] = model.curvature;
  for (std::size_t r = 0; r < 3; ++r) {
    if (index + r < first + 1 || index + r > cells.end()) continue;
    const auto row = static_cast<std::size_t>(index + r - first - 1);
    if (row >= cells.end() - first) continue;
    const auto& [m0, m1, m2] = *columns[r];
    gradient_[row] += m0 * model.gradient[0] + m1 * model.gradient[1] + m2 * model.gradient[2];
    const Three image{c00 * m0 + c01 * m1 + c02 * m2, c01 * m0 + c11 * m1 + c12 * m2,
                      c02 * m0 + c12 * m1 + c22 * m2};
    for (std::size_t k = r; k < 3; ++k) {
      const auto& [n0, n1, n2] = *columns[k];
      diagonal_[k - r][row] += image[0] * n0 + image[1] * n1 + image[2] * n2;
    }
  }
}

/// Symmetric elimination of five diagonals; those beyond the last row hold zeros.
void SpeedWindow::solve(std::size_t size) {
  auto& [d0, d1, d2] = diagonal_;
  for (std::size_t i = 0; i < size; ++i) step_[i] = -gradient_[i];
  for (std::size_t i = 0; i + 1 < size; ++i) {
    const double one = d1[i] / d0[i];
    d0[i + 1] -= one * d1[i];
    step_[i + 1] -= one * step_[i];
    if (i + 2 == size) break;
    const double two = d2[i] / d0[i];
    d1[i + 1] -= one * d2[i];
    d0[i + 2] -= two * d2[i];
    step_[i + 2] -= two * step_[i];
  }
  for (std::size_t i = size; i-- > 0;) {
    double sum = step_[i];
    if (i + 1 < size) sum -= d1[i] * step_[i + 1];
    if (i + 2 < size) sum -= d2[i] * step_[i + 2];
    step_[i] = sum / d0[i];
  }
}

double SpeedWindow::merit(std::uint64_t first, double part) const {
  const std::uint64_t touched = first_touched(first);
  double sum = 0.0;
  for (std::uint64_t i = touched; i != cells.end(); ++i) {
    const Goal& goal = goals_[i - touched];
    const CellX x = moved_x(i, first, part);
    if (!(x[0] > 0.0 && x[1] > 0.0 && x[2] > 0.0)) return kInfinity;
    sum += goal.cost(x, cells[i].cell.length / 3.0) + barrier(cells[i].cell, x, goal.defence);
  }
  return sum;
}

bool SpeedWindow::improve(std::uint64_t first) {
  const std::uint64_t touched = first_touched(first);
  const auto size = static_cast<std::size_t>(cells.end() - first);
  if (size == 0) return false;
  for (std::uint64_t i = touched; i != cells.end(); ++i) goals_[i - touched] = goal_of(i);
  assemble(first);
  solve(size);
  double promise = 0.0;
  for (std::size_t i = 0; i < size; ++i) promise -= gradient_[i] * step_[i];
  const double now = merit(first, 0.0);
  double part = 1.0;
  int halvings = 0;
  while (!(merit(first, part) <= now - kPartOfPromise * part * promise)) {
    if (++halvings > kMostHalvings) part = 0.0;
    if (part == 0.0) break;
    part *= 0.5;
  }
  bool settled = true;
  for (std::uint64_t i = touched; i != cells.end(); ++i) {
    PlannedCell& planned = cells[i];
    if (i >= first && part > 0.0) planned.x += part * step_[i - first];
    settled = settled && planned.weight <= kLeastWeight && planned.least <= kLeastLeast;
    if (part < kPartThatCounts) continue;
    planned.weight =
        std::max(std::min(planned.weight, kLeastWeight), planned.weight * kWeightDecay);
    planned.least = std::max(std::min(planned.least, kLeastLeast), planned.least * kLeastDecay);
  }
  return !settled || (part > 0.0 && promise > kNothingToGain * std::abs(now));
}

}  // namespace cnc::motion
