#include "motion/simplifier.h"

#include <cmath>
#include <utility>

namespace cnc::motion {

namespace {

/// Lines joined at most: each new one is compared with the vertices of all.
constexpr std::size_t kMostVertices = 64;

bool is_simple(const Piece& piece) {
  return piece.simplify > 0.0 && piece.kind == MoveKind::feed && is_straight(piece.curve);
}

bool wants_the_same(const Piece& a, const Piece& b) {
  return a.feed == b.feed && a.simplify == b.simplify && a.tolerance == b.tolerance &&
         a.laf_angle == b.laf_angle && a.override == b.override &&
         a.tag.spindle_speed == b.tag.spindle_speed && !b.tag.begins_at_index;
}

}  // namespace

bool Simplifier::add(const Piece& piece) {
  if (!is_simple(piece)) return false;
  if (!waiting_) {
    waiting_ = piece;
    start_ = point_of(piece.curve, 0.0);
    vertices_.clear();
    return true;
  }
  if (!joins(piece)) return false;
  vertices_.push_back(point_of(waiting_->curve, waiting_->end));
  waiting_->curve = Line(start_, point_of(piece.curve, piece.end));
  waiting_->end = length_of(waiting_->curve);
  waiting_->stop_at_end = piece.stop_at_end;
  return true;
}

/// Whether one line instead of both passes all vertices, in their order, within the tolerance.
bool Simplifier::joins(const Piece& piece) const {
  if (waiting_->stop_at_end || !wants_the_same(*waiting_, piece)) return false;
  if (measure_of(piece.curve) != measure_of(waiting_->curve)) return false;
  if (vertices_.size() >= kMostVertices) return false;
  const Position end = point_of(piece.curve, piece.end);
  const Position way = end - start_;
  const double length = norm(way);
  if (length < kShortest) return false;
  const Position direction = way * (1.0 / length);
  double last = 0.0;
  const auto fits = [&](const Position& vertex) {
    const Position offset = vertex - start_;
    const double along = dot(offset, direction);
    const bool in_order = along >= last && along <= length;
    last = along;
    return in_order && norm(offset - along * direction) <= waiting_->simplify;
  };
  for (const Position& vertex : vertices_) {
    if (!fits(vertex)) return false;
  }
  return fits(point_of(waiting_->curve, waiting_->end));
}

bool Simplifier::stop_at_end() {
  if (waiting_) waiting_->stop_at_end = true;
  return waiting_.has_value();
}

std::optional<Piece> Simplifier::take() { return std::exchange(waiting_, std::nullopt); }

}  // namespace cnc::motion
