// Finds the smallest program that still fails: what a failing random test prints.
//
// After QuickCheck's and Hypothesis' shrinking, and Zeller's delta debugging ("Simplifying and
// Isolating Failure-Inducing Input", IEEE TSE 28, 2002): parts are left out, large ones first, then
// what is left is made simpler piece by piece, as long as it goes on failing.
#pragma once

#include <cstddef>
#include <utility>

namespace cnc::motion::test {

/// A Program has size(), without(first, count) → Program, and simplify(accept), which offers
/// programs that are simpler in one thing until accept(program) says yes, and returns whether it
/// did. `fails` is asked `budget` times at most; `program` itself fails.
template <typename Program, typename Fails>
class Shrinker {
 public:
  Shrinker(Program program, Fails fails, int budget)
      : program_(std::move(program)), fails_(std::move(fails)), budget_(budget) {}

  Program smallest() {
    while (leave_out() || simplify()) continue;
    return std::move(program_);
  }

 private:
  bool take_if_failing(Program candidate) {
    if (budget_ <= 0) return false;
    --budget_;
    if (!fails_(candidate)) return false;
    program_ = std::move(candidate);
    return true;
  }

  /// Whether anything could be left out.
  bool leave_out() {
    const std::size_t before = program_.size();
    for (std::size_t count = before; count > 0; count /= 2) {
      for (std::size_t first = 0; first < program_.size();) {
        if (!take_if_failing(program_.without(first, count))) first += count;
      }
    }
    return program_.size() < before;
  }

  /// Whether anything could be made simpler.
  bool simplify() {
    bool any = false;
    const auto accept = [&](Program candidate) { return take_if_failing(std::move(candidate)); };
    while (Program(program_).simplify(accept)) any = true;
    return any;
  }

  Program program_;
  Fails fails_;
  int budget_;
};

template <typename Program, typename Fails>
[[nodiscard]] Program shrink(Program program, Fails fails, int budget = 2000) {
  return Shrinker(std::move(program), std::move(fails), budget).smallest();
}

}  // namespace cnc::motion::test
