// Work coordinates set by hand, and what is kept over a restart (MAN-6, CRD-1, STA-9).
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/config/temporary_directory.h"
#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using config::test::TemporaryDirectory;

namespace {

constexpr double kExact = 1e-9;

MachineData keeping(const std::filesystem::path& file, std::vector<std::string> settings = {}) {
  MachineData data = free_machine(std::move(settings));
  data.parameter_file = file;
  return data;
}

}  // namespace

TEST_CASE("Work zero makes the present position read as wanted", "[MAN-6]") {
  ReadyRig rig;
  REQUIRE(rig.mdi("G0 X10 Y20"));
  REQUIRE(rig.machine.set_work_zero({{Axis::X, 0.0}, {Axis::Y, 5.0}}));
  rig.simulation.cycle();
  CHECK(rig.shown()->work_position[Axis::X] == Approx(0.0).margin(kExact));
  CHECK(rig.shown()->work_position[Axis::Y] == Approx(5.0).margin(kExact));
  CHECK(rig.shown()->work_position[Axis::Z] == Approx(0.0).margin(kExact));
  REQUIRE(rig.mdi("G0 X1 Y5"));
  CHECK(rig.position()[Axis::X] == Approx(11.0).margin(kExact));
  CHECK(rig.position()[Axis::Y] == Approx(20.0).margin(kExact));
}

TEST_CASE("Work zero acts on the active system and takes G92 and tool length into account",
          "[MAN-6][CRD-1]") {
  ReadyRig rig;
  REQUIRE(rig.mdi("G0 X10 Z-50"));
  REQUIRE(rig.mdi("G55"));
  REQUIRE(rig.mdi("G92 X3"));
  REQUIRE(rig.mdi("G43 H3"));  // length 36.703 in the shipped tool table
  REQUIRE(rig.machine.set_work_zero({{Axis::X, 1.0}, {Axis::Z, 2.0}}));
  rig.simulation.cycle();
  CHECK(rig.shown()->work_system == 2);
  CHECK(rig.shown()->work_position[Axis::X] == Approx(1.0).margin(kExact));
  CHECK(rig.shown()->work_position[Axis::Z] == Approx(2.0).margin(kExact));
  REQUIRE(rig.mdi("G92.1"));
  REQUIRE(rig.mdi("G49"));
  REQUIRE(rig.mdi("G54"));
  CHECK(rig.shown()->work_position[Axis::X] == Approx(10.0).margin(kExact));  // G54 is untouched
}

TEST_CASE("Work zero is in millimetres while the program is in inches", "[MAN-6]") {
  ReadyRig rig;
  REQUIRE(rig.mdi("G20"));
  REQUIRE(rig.machine.set_work_zero({{Axis::X, 25.4}}));
  rig.simulation.cycle();
  CHECK(rig.shown()->work_position[Axis::X] == Approx(25.4).margin(1e-6));
}

TEST_CASE("A work zero that is no number, twice or nothing is refused", "[MAN-6]") {
  ReadyRig rig;
  const auto wrong = GENERATE(values<std::vector<WorkCoordinate>>(
      {{}, {{Axis::X, NAN}}, {{Axis::X, INFINITY}}, {{Axis::X, 1.0}, {Axis::X, 2.0}}}));
  CHECK_FALSE(rig.machine.set_work_zero(wrong));
  rig.simulation.cycle();
  CHECK(rig.shown()->work_position[Axis::X] == Approx(0.0).margin(kExact));
}

TEST_CASE("Work offsets survive a restart", "[CRD-1][STA-9]") {
  const TemporaryDirectory folder;
  const auto file = folder.file("parameters.txt");
  {
    ReadyRig rig(keeping(file));
    REQUIRE(rig.mdi("G10 L2 P2 X7"));
    REQUIRE(rig.machine.set_work_zero({{Axis::Y, -4.0}}));
  }
  const auto kept = config::ParameterStore::load(file);
  REQUIRE(kept);
  CHECK(kept->work_offset(2)[Axis::X] == Approx(7.0).margin(kExact));
  CHECK(kept->work_offset(1)[Axis::Y] == Approx(4.0).margin(kExact));

  MachineData data = keeping(file);
  data.parameters = *kept;
  ReadyRig rig(std::move(data));
  CHECK(rig.shown()->work_position[Axis::Y] == Approx(-4.0).margin(kExact));
}

TEST_CASE("Offsets that a job sets are kept when it ends, also by a stop", "[CRD-1][STA-9]") {
  const TemporaryDirectory folder;
  const auto file = folder.file("parameters.txt");
  {
    ReadyRig rig(keeping(file));
    rig.start("G10 L2 P3 Z-12\nG1 X50 F600\n");
    rig.run_for(1.0);
    REQUIRE(rig.stop());
  }
  const auto kept = config::ParameterStore::load(file);
  REQUIRE(kept);
  CHECK(kept->work_offset(3)[Axis::Z] == Approx(-12.0).margin(kExact));
}
