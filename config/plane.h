// The three planes of arcs and canned cycles, and which axes span them.
#pragma once

#include <cstdint>

#include "config/axis.h"

namespace cnc {

enum class Plane : std::uint8_t { xy, xz, yz };  ///< G17 G18 G19

/// First and second axis span the plane so that a counter-clockwise arc turns from first to second;
/// the third is the axis of a helix. Order as in NIST RS274/NGC: XY, ZX, YZ.
struct PlaneAxes {
  Axis first;
  Axis second;
  Axis third;
};

[[nodiscard]] constexpr PlaneAxes axes_of(Plane plane) {
  switch (plane) {
    case Plane::xy:
      return {Axis::X, Axis::Y, Axis::Z};
    case Plane::xz:
      return {Axis::Z, Axis::X, Axis::Y};
    case Plane::yz:
      return {Axis::Y, Axis::Z, Axis::X};
  }
  return {Axis::X, Axis::Y, Axis::Z};
}

}  // namespace cnc
