// The programs that the interpreter's benchmarks run, made by formula so that every run measures
// the same. Plain lines, arcs and the loop are those of ../shared/tools/linuxcnc_jobs.py.
#pragma once

#include <string>

namespace cnc::bench {

/// A 3D surface as CAM systems write it: short moves, some words left out.
[[nodiscard]] std::string straight_lines(int lines);
[[nodiscard]] std::string arcs(int count);
/// A loop of seven lines with four sin or cos.
[[nodiscard]] std::string loop(int rounds);
/// The same in the words of LinuxCNC.
[[nodiscard]] std::string loop_for_linuxcnc(int rounds);
/// A loop of four lines, one of which is the gosub.
[[nodiscard]] std::string sub_calls(int calls);
/// G81, one hole per line.
[[nodiscard]] std::string holes(int count);
/// G41 along stairs: inside and outside corners in turn.
[[nodiscard]] std::string compensated_moves(int count);

}  // namespace cnc::bench
