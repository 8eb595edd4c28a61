#include "tests/server/macro_rig.h"

#include <catch2/catch.hpp>

namespace cnc::server::test {
namespace {

SimulationOptions bench() {
  SimulationOptions options = at_zero();
  // A slope, so that every point of a grid has a height of its own.
  options.machine.touch.stock = [](double x, double y) {
    return x > 200.0 ? -200.0 : kStockTop + 0.1 * x + 0.05 * y;
  };
  options.machine.touch.tool_setter =
      hal::sim::ToolSetter{.x = 500, .y = 300, .half_width = 20, .top = kSetterTop};
  options.machine.loop_back_delay = 0.02;
  return options;
}

}  // namespace

MacroRig::MacroRig(std::string_view macros, std::vector<std::string> settings,
                   bool mandatory_homing)
    : rig(data(macros, std::move(settings), mandatory_homing), bench()) {
  REQUIRE(rig.reset());
}

MachineData MacroRig::data(std::string_view macros, std::vector<std::string> settings,
                           bool mandatory_homing) const {
  config::test::put(folder.file("macro.cnc"), macros);
  MachineData machine = mandatory_homing ? shipped_machine() : free_machine(std::move(settings));
  machine.macro_files = {folder.file("macro.cnc"), folder.file("user_macro.cnc")};
  machine.parameter_file = folder.file("parameters.txt");
  machine.tool_file = folder.file("tools.txt");
  machine.program_folder = folder.file("files");
  machine.config_file = folder.file("cnc.ini");
  return machine;
}

bool MacroRig::waits_for_operator() const {
  return rig.state() == State::question || rig.state() == State::program_stop ||
         rig.state() == State::tool_change;
}

Result<void> MacroRig::run(const std::string& line, const std::vector<double>& values,
                           bool confirmed) {
  auto answer = std::make_shared<std::optional<Result<void>>>();
  rig.machine.mdi(line, [answer](Result<void> result) { *answer = std::move(result); });
  for (int rounds = 0; rounds < 100 && !answer->has_value(); ++rounds) {
    REQUIRE(
        rig.becomes_with_disk([&] { return answer->has_value() || waits_for_operator(); }, 300.0));
    if (answer->has_value()) break;
    rig.simulation.cycle();
    if (rig.state() == State::question) {
      const auto question = rig.shown()->question;
      REQUIRE(question.has_value());
      REQUIRE(rig.machine.answer(question->number, confirmed, values));
    } else {
      if (on_stop) on_stop();
      REQUIRE(rig.machine.resume());
    }
  }
  REQUIRE(answer->has_value());
  rig.simulation.cycle();
  if (!answer->value()) UNSCOPED_INFO(answer->value().error().to_string());
  return **answer;
}

std::string MacroRig::messages() const {
  std::string all;
  for (const LogMessage& message : rig.simulation.log().after(0)) all += message.text + "|";
  return all;
}

}  // namespace cnc::server::test
