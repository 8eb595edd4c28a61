// Two numbers at once, in one vector register of every processor that this runs on.
#pragma once

namespace cnc::motion {

using Pair [[gnu::vector_size(2 * sizeof(double))]] = double;

[[nodiscard]] inline Pair both(double value) { return Pair{value, value}; }
[[nodiscard]] inline Pair smaller(Pair a, Pair b) { return a < b ? a : b; }
[[nodiscard]] inline Pair larger(Pair a, Pair b) { return a > b ? a : b; }
[[nodiscard]] inline Pair absolute(Pair a) { return larger(a, -a); }
[[nodiscard]] inline double larger_of(Pair a) { return a[0] > a[1] ? a[0] : a[1]; }
[[nodiscard]] inline double smaller_of(Pair a) { return a[0] < a[1] ? a[0] : a[1]; }

}  // namespace cnc::motion
