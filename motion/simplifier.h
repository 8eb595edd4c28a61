// Line simplification (G61 Q, G64 Q): consecutive short lines become one long line that leaves none
// of their vertices by more than the tolerance.
//
// A joined line has the tag of its first move: what the program wants done between two moves that
// were joined happens behind the line.
//
// What joins is decided when the next line is known: one line at most waits in here.
#pragma once

#include <optional>
#include <vector>

#include "motion/piece.h"

namespace cnc::motion {

class Simplifier {
 public:
  /// Whether the piece has been joined to the line that waits, or waits itself now for others to be
  /// joined. If not, take() first, then give it again; what is refused then goes on as it is.
  [[nodiscard]] bool add(const Piece& piece);
  /// The line that waits.
  [[nodiscard]] std::optional<Piece> take();
  /// The machine shall stand still at the end of the line that waits; false when none does.
  bool stop_at_end();
  [[nodiscard]] bool empty() const { return !waiting_; }
  void clear() { waiting_.reset(); }

 private:
  [[nodiscard]] bool joins(const Piece& piece) const;

  std::optional<Piece> waiting_;
  Position start_;
  std::vector<Position> vertices_;  // between its two ends
};

}  // namespace cnc::motion
