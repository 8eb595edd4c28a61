// What is known of where the axes stand: which event takes how much trust, and what gives it back
// (LNK-4). With machines and faults: link_loss_test.cpp.
#include "server/machine/position_trust.h"

#include <catch2/catch.hpp>
#include <string>

using namespace cnc;
using namespace cnc::server;
using Catch::Contains;

namespace {

constexpr AxisArray<bool> kXyz{{true, true, true, false, false, false}};

PositionTrust homed() {
  PositionTrust trust(kXyz);
  for (const Axis axis : kLinearAxes) trust.homed(axis);
  return trust;
}

AxisArray<bool> trusted_axes(const PositionTrust& trust) {
  AxisArray<bool> axes;
  for (const Axis axis : kAllAxes) axes[axis] = trust[axis] == Trust::trusted;
  return axes;
}

}  // namespace

TEST_CASE("At power-up no axis is known, and nothing but homing changes that", "[LNK-4][HOM-2]") {
  PositionTrust trust(kXyz);
  for (const Axis axis : kAllAxes) CHECK(trust[axis] == Trust::unknown);
  const auto refused = trust.accept({Axis::X});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::never_homed);
  CHECK_THAT(refused.error().message, Contains("X has not been homed"));
  CHECK(trust[Axis::X] == Trust::unknown);
  trust.homed(Axis::X);
  CHECK(trust[Axis::X] == Trust::trusted);
  CHECK(trusted_axes(trust) == only(Axis::X));
}

TEST_CASE("Each event leaves the axes that it concerns so much trust, the others all",
          "[LNK-4][STA-4]") {
  struct Row {
    TrustEvent event;
    Trust trusted_before;  // what becomes of an axis that was trusted
    Trust doubtful_before;
  };
  const Row row = GENERATE(values<Row>({
      // counted on, but the motor may have slipped
      {TrustEvent::stopped_on_the_spot, Trust::doubtful, Trust::doubtful},
      // the board may have run dry, and then it stopped on the spot
      {TrustEvent::link_lost, Trust::doubtful, Trust::doubtful},
      // the board counts from 0 again
      {TrustEvent::counts_lost, Trust::unknown, Trust::unknown},
      // nobody counts what the motor has not done
      {TrustEvent::steps_lost, Trust::unknown, Trust::unknown},
      // the axis still counts as it did
      {TrustEvent::homing_begun, Trust::doubtful, Trust::doubtful},
      // a motor without current can be turned, and a vertical axis sags
      {TrustEvent::drives_off, Trust::doubtful, Trust::doubtful},
  }));
  PositionTrust trust = homed();
  trust.take(TrustEvent::stopped_on_the_spot, only(Axis::Y));
  AxisArray<bool> concerned = only(Axis::X);
  concerned[Axis::Y] = true;
  trust.take(row.event, concerned);
  CHECK(trust[Axis::X] == row.trusted_before);
  CHECK(trust[Axis::Y] == row.doubtful_before);
  CHECK(trust[Axis::Z] == Trust::trusted);
  CHECK_FALSE(trust.all_trusted());
}

TEST_CASE("No event gives trust back", "[LNK-4][safety]") {
  for (const TrustEvent first :
       {TrustEvent::stopped_on_the_spot, TrustEvent::link_lost, TrustEvent::counts_lost,
        TrustEvent::steps_lost, TrustEvent::homing_begun}) {
    for (const TrustEvent second :
         {TrustEvent::stopped_on_the_spot, TrustEvent::link_lost, TrustEvent::counts_lost,
          TrustEvent::steps_lost, TrustEvent::homing_begun}) {
      PositionTrust trust = homed();
      trust.take(first, only(Axis::X));
      const Trust before = trust[Axis::X];
      const AxisArray<bool> less = trust.take(second, only(Axis::X));
      CHECK(trust[Axis::X] >= before);
      CHECK(less[Axis::X] == (trust[Axis::X] != before));
    }
  }
}

TEST_CASE("An event that concerns no axis changes nothing", "[LNK-4]") {
  PositionTrust trust = homed();
  CHECK(trust.take(TrustEvent::stopped_on_the_spot, {}) == AxisArray<bool>{});
  CHECK(trust.all_trusted());
  CHECK(trust.advice().empty());
}

TEST_CASE("The operator's word makes axes trusted that were homed once: those named, or all",
          "[LNK-4]") {
  PositionTrust trust = homed();
  trust.take(TrustEvent::counts_lost, kXyz);
  REQUIRE(trust.accept({Axis::Y}));
  CHECK(trusted_axes(trust) == only(Axis::Y));
  const auto rest = trust.accept({});
  REQUIRE(rest);
  CHECK(*rest == std::vector{Axis::X, Axis::Z});
  CHECK(trust.all_trusted());
}

TEST_CASE("One axis that was never homed is reason to accept none", "[LNK-4][safety]") {
  PositionTrust trust(kXyz);
  trust.homed(Axis::Z);
  trust.take(TrustEvent::stopped_on_the_spot, only(Axis::Z));
  const auto refused = trust.accept({});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::never_homed);
  CHECK_THAT(refused.error().message, Contains("X and Y have not been homed"));
  CHECK(trust[Axis::Z] == Trust::doubtful);
}

TEST_CASE("The advice says which axes, how bad it is and what to do", "[LNK-4]") {
  PositionTrust trust = homed();
  trust.take(TrustEvent::stopped_on_the_spot, {{true, true, false, false, false, false}});
  CHECK(trust.advice() ==
        "The position of X and Y is doubtful. Home X and Y, or check and accept the position.");
  trust.take(TrustEvent::counts_lost, only(Axis::Y));
  CHECK(trust.advice() ==
        "The position of X is doubtful. The position of Y is not known. Home X and Y, or check and "
        "accept the position.");
  // Nobody can check what was never known.
  CHECK(PositionTrust(kXyz).advice() ==
        "The position of X, Y and Z is not known. Home X, Y and Z.");
}

TEST_CASE("Axes that cannot be homed are nobody's concern", "[LNK-4]") {
  PositionTrust trust = homed();
  CHECK(trust.all_trusted());
  trust.take(TrustEvent::counts_lost, AxisArray<bool>::filled(true));
  CHECK(trust[Axis::A] == Trust::unknown);
  REQUIRE(trust.accept({}));
  CHECK(trust.all_trusted());
  CHECK(trust[Axis::A] == Trust::unknown);
}
