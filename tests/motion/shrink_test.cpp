// A planted failure comes out as the smallest program that shows it.
#include "tests/motion/shrink.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/motion/program_judge.h"
#include "tests/motion/program_text.h"
#include "tests/motion/random_program.h"

namespace cnc::motion::test {

namespace {

RandomProgram program_with_seed(std::uint32_t seed) {
  Dice dice(seed);
  return random_program(dice, 200);
}

}  // namespace

TEST_CASE("A failure that one move makes is shrunk to that move alone", "[property]") {
  // Planted: a program fails when it has a feed move that goes up by more than 1 mm.
  const auto fails = [](const RandomProgram& program) {
    return std::any_of(program.steps.begin(), program.steps.end(), [](const ProgramStep& step) {
      return step.options.kind == MoveKind::feed && step.way[Axis::Z] > 1.0;
    });
  };
  int failing = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const RandomProgram program = program_with_seed(seed);
    if (!fails(program)) continue;
    ++failing;
    const RandomProgram smallest = shrink(program, fails);
    CAPTURE(seed, text_of(smallest));
    REQUIRE(smallest.size() == 1);
    const ProgramStep& step = smallest.steps.front();
    CHECK(step.way[Axis::Z] > 1.0);
    // Halving would no longer fail, and so would rounding to fewer digits.
    CHECK(step.way[Axis::Z] <= 2.0);
    CHECK(step.way[Axis::X] == 0.0);
    CHECK(step.way[Axis::Y] == 0.0);
    CHECK_FALSE(step.is_arc);
    CHECK(step.event == Event::none);
    CHECK(step.options.feed == 100.0);
    CHECK(step.options.tolerance == 0.0);
    CHECK_FALSE(step.options.stop_at_end);
  }
  CHECK(failing > 5);
}

TEST_CASE("A failure that takes three moves in order is shrunk to three", "[property]") {
  // Planted: an arc, later a rapid, later a hold.
  const auto fails = [](const RandomProgram& program) {
    int seen = 0;
    for (const ProgramStep& step : program.steps) {
      if (seen == 0 && step.is_arc) ++seen;
      if (seen == 1 && step.options.kind == MoveKind::rapid) ++seen;
      if (seen == 2 && step.event == Event::hold) return true;
    }
    return false;
  };
  int failing = 0;
  for (std::uint32_t seed = 1; seed <= 80; ++seed) {
    const RandomProgram program = program_with_seed(seed);
    if (!fails(program)) continue;
    ++failing;
    const RandomProgram smallest = shrink(program, fails);
    CAPTURE(seed, text_of(smallest));
    // The hold may stand before the rapid itself.
    CHECK(smallest.size() <= 3);
    CHECK(smallest.size() >= 2);
    CHECK(fails(smallest));
  }
  CHECK(failing >= 5);
}

TEST_CASE("A limit that the planner does not know of is found, and shrunk to a few moves",
          "[property]") {
  // Planted: the judge's limit of Y is half of what the planner was told.
  const auto fails = [](const RandomProgram& program) {
    RandomProgram told = program;
    told.settings.limits.max_acceleration[Axis::Y] *= 2.0;
    return !judge(program, told.settings.limits).is_sound();
  };
  int failing = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    Dice dice(seed);
    const RandomProgram program = random_program(dice, 60);
    if (!fails(program)) continue;
    ++failing;
    const RandomProgram smallest = shrink(program, fails, 600);
    CAPTURE(seed, text_of(smallest));
    CHECK(smallest.size() <= 2);
    CHECK(fails(smallest));
  }
  CHECK(failing > 2);
}

TEST_CASE("A program that does not fail any more when it is asked again stays as it is",
          "[property]") {
  const RandomProgram program = program_with_seed(1);
  CHECK(shrink(program, [](const RandomProgram&) { return false; }).size() == program.size());
}

TEST_CASE("A random program that was printed can be read again", "[property]") {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const std::string text = text_of(program_with_seed(seed));
    CHECK(text_of(program_of(text)) == text);
  }
}

TEST_CASE("A random program prints as G-code", "[property]") {
  RandomProgram program;
  program.settings.limits = {Position::filled(100.0), Position::filled(500.0)};
  ProgramStep line;
  line.way[Axis::X] = 0.25;
  line.options.feed = 50.0;
  line.options.tolerance = 0.02;
  ProgramStep arc = line;
  arc.is_arc = true;
  arc.way[Axis::X] = 2.0;
  arc.first_centre = 1.0;
  arc.turns = -1;
  arc.event = Event::hold;
  arc.draws = 3;
  program.steps = {line, arc};
  CHECK(text_of(program) ==
        "(X Y Z: 100 100 100 mm/s, 500 500 500 mm/s2; setpoints of 0.005 s)\n"
        "G21 G91\n"
        "G64 P0.02\n"
        "G1 X0.25 F3000\n"
        "(3 setpoints)\n"
        "(hold until standstill, resume)\n"
        "G17 G2 X2 I1 J0 F3000\n");
}

}  // namespace cnc::motion::test
