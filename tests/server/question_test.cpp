// Programs that wait for the operator: dialogs, and stops in which he jogs (LNG-4, JOB-8).
#include <catch2/catch.hpp>

#include "tests/server/macro_rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Catch::Contains;

TEST_CASE("A dialog stops the machine until it is answered, by its number", "[LNG-4]") {
  MacroRig macro(
      "sub ask\n#1 = 5\ndlgmsg \"How far?\" \"X\" 1\nif [#5398 == 1]\nG0 X#1\nendif\nendsub");
  macro.rig.machine.mdi("gosub ask", [](const Result<void>&) {});
  REQUIRE(macro.rig.becomes(State::question));
  macro.rig.simulation.cycle();
  const auto question = macro.rig.shown()->question;
  REQUIRE(question.has_value());
  CHECK(question->title == "How far?");
  REQUIRE(question->fields.size() == 1);
  CHECK(question->fields[0].label == "X");
  CHECK(question->fields[0].value == 5.0);
  const auto refused = [&](std::uint64_t number, std::vector<double> values) {
    const auto answer = macro.rig.machine.answer(number, true, std::move(values));
    return answer ? std::string("accepted") : std::string(error_info(answer.error().code).name);
  };
  CHECK(refused(question->number + 1, {}) == "no_question");
  CHECK(refused(question->number, {1, 2}) == "value_out_of_range");
  CHECK(refused(question->number, {std::numeric_limits<double>::quiet_NaN()}) ==
        "value_out_of_range");
  CHECK(refused(question->number, {12.5}) == "accepted");
  CHECK(macro.rig.state() == State::mdi);
  CHECK(refused(question->number, {12.5}) == "no_question");  // another client was faster
  REQUIRE(macro.rig.becomes(State::ready));
  CHECK(macro.rig.position()[Axis::X] == Approx(12.5));
  CHECK(refused(question->number, {12.5}) == "no_question");
}

TEST_CASE("A stopped question ends the program and answers nobody", "[LNG-4]") {
  MacroRig macro("sub ask\ndlgmsg \"?\"\nG0 X10\nendsub");
  std::optional<Result<void>> answer;
  macro.rig.machine.mdi("gosub ask", [&](Result<void> result) { answer = std::move(result); });
  REQUIRE(macro.rig.becomes(State::question));
  REQUIRE(macro.rig.stop());
  CHECK(macro.rig.state() == State::ready);
  REQUIRE(answer.has_value());
  CHECK_FALSE(answer->has_value());
  CHECK_FALSE(macro.rig.shown()->question.has_value());
  CHECK(macro.rig.position()[Axis::X] == 0.0);
}

TEST_CASE("While a program waits the operator may jog, and it goes on from there", "[JOB-8]") {
  MacroRig macro("sub park\nwarnmsg \"Jog away, then resume\"\n#4996 = #5071\nG0 Y10\nendsub");
  macro.on_stop = [&] {
    REQUIRE(macro.rig.machine.jog_step(Axis::X, 7.0, 0.5));
    CHECK(macro.rig.state() == State::jogging);
    REQUIRE(macro.rig.becomes(State::program_stop));
  };
  REQUIRE(macro.run("gosub park"));
  CHECK(macro.rig.position()[Axis::X] == Approx(7.0));
  CHECK(macro.rig.position()[Axis::Y] == Approx(10.0));
  REQUIRE(macro.run("G0 X#4996"));
  CHECK(macro.rig.position()[Axis::X] == Approx(7.0));
}

TEST_CASE("A stop while jogging in a waiting program ends both", "[JOB-8]") {
  MacroRig macro("sub park\nM0\nG0 Y10\nendsub");
  macro.rig.machine.mdi("gosub park", [](const Result<void>&) {});
  REQUIRE(macro.rig.becomes(State::program_stop));
  REQUIRE(macro.rig.machine.jog_step(Axis::X, 100.0, 0.5));
  macro.rig.run_for(0.3);
  REQUIRE(macro.rig.stop());
  CHECK(macro.rig.state() == State::ready);
  CHECK(macro.rig.position()[Axis::X] > 0.0);
  CHECK(macro.rig.position()[Axis::X] < 100.0);
  REQUIRE(macro.rig.mdi("G0 X0"));
  CHECK(macro.rig.position()[Axis::Y] == 0.0);
}

TEST_CASE("A dialog value that its parameter cannot have is refused and asked again", "[LNG-4]") {
  MacroRig macro("sub ask\ndlgmsg \"Tool\" \"Diameter\" 5507\nendsub");
  macro.rig.machine.mdi("gosub ask", [](const Result<void>&) {});
  REQUIRE(macro.rig.becomes(State::question));
  macro.rig.simulation.cycle();
  const std::uint64_t number = macro.rig.shown()->question->number;
  CHECK_FALSE(macro.rig.machine.answer(number, true, {1e6}));
  CHECK(macro.rig.state() == State::question);
  CHECK(macro.rig.machine.answer(number, true, {6.0}));
  REQUIRE(macro.rig.becomes(State::ready));
  REQUIRE(macro.run("msg \"diameter \"#5507"));
  CHECK_THAT(macro.messages(), Contains("diameter 6"));
}
