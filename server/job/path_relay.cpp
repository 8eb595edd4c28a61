#include "server/job/path_relay.h"

namespace cnc::server {

void PathRelay::append(const motion::Piece& piece) {
  queue_.add(piece);
  ++passed_on_;
  tag_ = piece.tag;
  position_ = motion::point_of(piece.curve, piece.end);
}

std::optional<motion::Stretch> PathRelay::skip() {
  if (empty()) return std::nullopt;
  passed_on_ = 0;
  return motion::Stretch{0.0, tag_};
}

}  // namespace cnc::server
