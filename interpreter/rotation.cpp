// G50 G51 G68 G69: scaling and rotation of the XY plane.
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"

namespace cnc::interp {
namespace {

constexpr double kMinFactor = 0.001;
constexpr double kMaxFactor = 1000.0;

Accepted check_axes(const Execution& x) {
  for (const Axis axis : {Axis::Z, Axis::A, Axis::B, Axis::C}) {
    if (!x.block().has(axis)) continue;
    const char letter = axis_name(axis)[0];
    return refuse(
        ErrorCode::word_unused, x.block().span_of(letter),
        fmt::format("{} works in the XY plane: it has no word {}.", x.code_name(), letter),
        "X and Y.");
  }
  return {};
}

/// Moves the common point to the words that are there, work coordinates.
void use_point(Execution& x, char x_letter, char y_letter) {
  XyTransform& transform = x.state().coordinates.transform();
  const MachineState& state = x.state();
  const Block& block = x.block();
  const double x_scale = x_letter == 'X' ? state.scale(Axis::X) : state.scale();
  transform.set_point(
      block.has(x_letter) ? block.value(x_letter) * x_scale : transform.x_point(),
      block.has(y_letter) ? block.value(y_letter) * state.scale() : transform.y_point());
}

/// When neither is left, the next one begins with its point at work zero again.
void forget_unused_point(Execution& x) {
  const ModalState& modal = x.state().modal;
  if (!modal.rotated && !modal.scaled) x.state().coordinates.transform().set_point(0.0, 0.0);
}

Parsed<double> factor(const Execution& x, char letter) {
  const double value = x.block().find(letter).value_or(1.0);
  if (value >= kMinFactor && value <= kMaxFactor) return value;
  return refuse(ErrorCode::word_out_of_range, x.block().span_of(letter),
                fmt::format("{} cannot scale by {:.10g}.", x.code_name(), value),
                fmt::format("{} from {} to {}.", letter, kMinFactor, kMaxFactor));
}

/// P for both axes, or X and Y for each.
Accepted check_factor_words(const Execution& x) {
  const Block& block = x.block();
  const bool each = block.has('X') || block.has('Y');
  if (block.has('P') != each) return {};
  if (!each) {
    return refuse(ErrorCode::word_missing, x.code_span(), "G51 has no scaling factor.",
                  "P, or X and Y.");
  }
  return refuse(ErrorCode::word_claimed_twice, block.span_of('P'),
                "G51 has one factor for both axes and factors for each.", "P, or X and Y.");
}

}  // namespace

Accepted rotate(Execution& x) {
  if (Accepted axes = check_axes(x); !axes) return axes;
  use_point(x, 'X', 'Y');
  x.state().coordinates.transform().set_rotation(x.block().value('R'));
  x.state().modal.rotated = true;
  return {};
}

Accepted cancel_rotation(Execution& x) {
  x.state().coordinates.transform().set_rotation(0.0);
  x.state().modal.rotated = false;
  forget_unused_point(x);
  return {};
}

Accepted scale(Execution& x) {
  if (Accepted axes = check_axes(x); !axes) return axes;
  if (Accepted given = check_factor_words(x); !given) return given;
  const bool uniform = x.block().has('P');
  const auto x_factor = factor(x, uniform ? 'P' : 'X');
  if (!x_factor) return std::unexpected(x_factor.error());
  const auto y_factor = factor(x, uniform ? 'P' : 'Y');
  if (!y_factor) return std::unexpected(y_factor.error());
  use_point(x, 'I', 'J');
  x.state().coordinates.transform().set_factors(*x_factor, *y_factor);
  x.state().modal.scaled = true;
  return {};
}

Accepted cancel_scaling(Execution& x) {
  x.state().coordinates.transform().set_factors(1.0, 1.0);
  x.state().modal.scaled = false;
  forget_unused_point(x);
  return {};
}

}  // namespace cnc::interp
