// Scenario files: what they say, and what is refused.
#include "hal/sim/scenario.h"

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "tests/hal/machine_support.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::sim;

namespace {

const std::filesystem::path kExamples = CNC_SOURCE_DIR "/config/scenarios";

Scenario scenario(std::string_view text) {
  const Result<Scenario> result = parse_scenario(text, "test.toml");
  INFO((result ? "" : result.error().to_string()));
  REQUIRE(result);
  return *result;
}

constexpr std::string_view kEverything = R"(
[machine]
seed = 12
start = { X = 1, Z = -3.5 }
stop_margin = 7.0
limit_switch_margin = 3.0
switch_hysteresis = 0.5
switch_bounce = 0.01
loop_back_delay = 0.02
io_cards = [1, 3]
ports_on = [2, 101]
analog = [0.5, 0.25]
[axis.X]
acceleration = 1500.0
corner_velocity = 40.0
top_velocity = 90.0
microsteps = 16
closed_loop = true
limit_low_port = 3
limit_high_port = 208
limits_in_estop_chain = true
[door]
port = 5
open = true
in_estop_chain = true
stops_spindle = true
stops_coolant = true
[stock]
x = -5
y = 0
dx = 10
dy = 20
heights = [[0, 1, 2], [4, 5, 10]]
[tool_setter]
x = 1.0
y = 2.0
top = 3.0
half_width = 4.0
[[tool]]
number = 4
length = 50.5
[spindle]
time_constant = 0.2
acceleration = 3000
sync_width = 0.05
[[heater]]
pwm = 2
analog = 3
power = 10.0
capacity = 11.0
loss = 0.5
ambient = 21.0
sensor_range = 300.0
[link]
cable_out = true
loss = 0.1
duplication = 0.2
corruption = 0.3
delay = 0.004
jitter = 0.005
)";

}  // namespace

TEST_CASE("An empty scenario is a sound machine", "[hal][scenario]") {
  const Scenario empty = scenario("");
  CHECK(empty.events.empty());
  CHECK_FALSE(empty.machine.start);
  CHECK(empty.machine.stop_margin == 5.0);
  CHECK_FALSE(empty.machine.door);
  CHECK(empty.machine.io_cards == std::array{true, true, true});
  CHECK_FALSE(empty.link.cable_out);
}

TEST_CASE("Every key of the machine's tables arrives where it belongs", "[hal][scenario]") {
  const Scenario read = scenario(kEverything);
  const MachineOptions& machine = read.machine;
  CHECK(machine.seed == 12);
  REQUIRE(machine.start);
  CHECK(machine.start->values == std::array{1.0, 0.0, -3.5, 0.0, 0.0, 0.0});
  CHECK(machine.stop_margin == 7.0);
  CHECK(machine.limit_switch_margin == 3.0);
  CHECK(machine.switch_hysteresis == 0.5);
  CHECK(machine.switch_bounce == 0.01);
  CHECK(machine.loop_back_delay == 0.02);
  CHECK(machine.io_cards == std::array{true, false, true});
  CHECK(machine.ports_on == 0x1'0002);  // AUX2 is bit 1, 101 follows the sixteen AUX
  CHECK(machine.analog == std::array{0.5, 0.25, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  const AxisOptions& x = machine.axes[Axis::X];
  CHECK(x.motor.acceleration == 1500.0);
  CHECK(x.motor.corner_velocity == 40.0);
  CHECK(x.motor.top_velocity == 90.0);
  CHECK(x.motor.microsteps == 16.0);
  CHECK(x.motor.closed_loop);
  CHECK(x.limit_low_port == port_bit(3));
  CHECK(x.limit_high_port == port_bit(208));
  CHECK(x.limits_in_estop_chain);
  CHECK_FALSE(machine.axes[Axis::Y].motor.closed_loop);
  REQUIRE(machine.door);
  CHECK(machine.door->port == port_bit(5));
  CHECK(machine.door->open);
  CHECK(machine.door->in_estop_chain);
  CHECK(machine.door->stops_spindle);
  CHECK(machine.door->stops_coolant);
  CHECK(machine.touch.stock(-5, 0) == 0.0);
  CHECK(machine.touch.stock(15, 20) == 10.0);
  REQUIRE(machine.touch.tool_setter);
  CHECK(machine.touch.tool_setter->x == 1.0);
  CHECK(machine.touch.tool_setter->y == 2.0);
  CHECK(machine.touch.tool_setter->top == 3.0);
  CHECK(machine.touch.tool_setter->half_width == 4.0);
  CHECK(machine.touch.tool_lengths == std::map<int, double>{{4, 50.5}});
  CHECK(machine.spindle.time_constant == 0.2);
  CHECK(machine.spindle.acceleration == 3000.0);
  CHECK(machine.spindle.sync_width == 0.05);
  REQUIRE(machine.heaters.size() == 1);
  const HeaterOptions& heater = machine.heaters[0];
  CHECK(heater.pwm == 1);
  CHECK(heater.analog == 2);
  CHECK(heater.power == 10.0);
  CHECK(heater.capacity == 11.0);
  CHECK(heater.loss == 0.5);
  CHECK(heater.ambient == 21.0);
  CHECK(heater.sensor_range == 300.0);
  CHECK(read.link.cable_out);
  CHECK(read.link.loss == 0.1);
  CHECK(read.link.duplication == 0.2);
  CHECK(read.link.corruption == 0.3);
  CHECK(read.link.delay == 0.004);
  CHECK(read.link.jitter == 0.005);
}

TEST_CASE("A level stock has one height everywhere", "[hal][scenario]") {
  const Scenario level = scenario("[stock]\nheight = 12.5\n");
  CHECK(level.machine.touch.stock(-1000, 1000) == 12.5);
}

TEST_CASE("Comments may be in any language, from any editor, behind texts too", "[hal][scenario]") {
  const Scenario read = scenario(
      "\xEF\xBB\xBF# f\u00fcr \u0353 die Pr\u00fcfung\r\n[[event]]\r\nat = 1\r\n"
      "action = \"estop_press\" # Not-Aus gedr\u00fcckt, \"ganz\"\r\nchannel = '2' # \u00e4\r\n");
  REQUIRE(read.events.size() == 1);
  CHECK_FALSE(std::get<EstopButton>(read.events[0].action).channel1);
}

TEST_CASE("Events have a time or a place", "[hal][scenario]") {
  const Scenario read = scenario(R"(
[[event]]
at = 1.5
action = "cable_out"
[[event]]
when = { axis = "Y", below = -2.5 }
action = "estop_press"
channel = "2"
)");
  REQUIRE(read.events.size() == 2);
  CHECK(std::get<cpu5::firmware::Ticks>(read.events[0].when) == 15'000'000);
  CHECK(std::get<CableMoves>(read.events[0].action).out);
  const auto& place = std::get<PlacePassed>(read.events[1].when);
  CHECK(place.axis == Axis::Y);
  CHECK(place.place == -2.5);
  CHECK_FALSE(place.upwards);
  const auto& button = std::get<EstopButton>(read.events[1].action);
  CHECK_FALSE(button.channel1);
  CHECK(button.channel2);
  CHECK(button.pressed);
}

TEST_CASE("What is wrong in a scenario is told with its line and what would be right",
          "[hal][scenario]") {
  struct Row {
    const char* text;
    ErrorCode code;
    unsigned line;
    const char* says;
  };
  using enum ErrorCode;
  const Row row = GENERATE(values<Row>({
      {"[machine\n", scenario_not_toml, 1, "TOML"},
      {"a = 1\na = 2\n", scenario_not_toml, 2, "TOML"},
      {"[machine]\nseed = 1 \u00e4\n", scenario_not_toml, 2, "not ASCII"},
      {"[machine] # \u00e4\n\u00e4 = 1\n", scenario_not_toml, 2, "not ASCII"},
      {"[machin]\nseed = 1\n", scenario_unknown_key, 1, "is machine meant?"},
      {"[machine]\n\nstop_margn = 1\n", scenario_unknown_key, 3, "is stop_margin meant?"},
      {"[axis.X]\ntop_speed = 1\n", scenario_unknown_key, 2,
       "X of [axis] has no key \"top_speed\""},
      {"[axis.U]\ntop_velocity = 1\n", scenario_unknown_key, 1, "[axis] has no key \"U\""},
      {"[machine]\nstart = { Q = 1 }\n", scenario_unknown_key, 2, "start of [machine]"},
      {"[link]\ncable = true\n", scenario_unknown_key, 2, "cable_out"},
      {"[[event]]\nat = 1\naction = \"cable_out\"\naxis = \"X\"\n", scenario_unknown_key, 4,
       "[[event]] 1 has no key \"axis\""},
      {"machine = 1\n", scenario_wrong_type, 1, "a table, [machine]"},
      {"[machine]\nstop_margin = \"5\"\n", scenario_wrong_type, 2, "a number, 0 to 1000 mm"},
      {"[machine]\nseed = 1.5\n", scenario_wrong_type, 2, "a whole number"},
      {"[machine]\nanalog = 0.5\n", scenario_wrong_type, 2, "a list of numbers"},
      {"[machine]\nports_on = 5\n", scenario_wrong_type, 2, "a list of port numbers"},
      {"[door]\nopen = 1\n", scenario_wrong_type, 2, "true or false"},
      {"[tool]\nnumber = 1\n", scenario_wrong_type, 1, "[[tool]]"},
      {"tool = [1]\n", scenario_wrong_type, 1, "[[tool]]"},
      {"[stock]\nx=0\ny=0\ndx=1\ndy=1\nheights = [[1, 2], [3]]\n", scenario_wrong_type, 6,
       "same length"},
      {"[stock]\nx=0\ny=0\ndx=1\ndy=1\nheights = [[1, 2]]\n", scenario_wrong_type, 6,
       "two or more"},
      {"[stock]\nx=0\ny=0\ndx=1\ndy=1\nheights = [1, 2]\n", scenario_wrong_type, 6, "rows"},
      {"[[event]]\nat = 1\naction = 5\n", scenario_wrong_type, 3, "one of \"cable_out\""},
      {"[machine]\nstop_margin = -0.5\n", scenario_out_of_range, 2, "0 to 1000"},
      {"[machine]\nstop_margin = nan\n", scenario_out_of_range, 2, "0 to 1000"},
      {"[machine]\nstop_margin = inf\n", scenario_out_of_range, 2, "0 to 1000"},
      {"[axis.Z]\nacceleration = 0\n", scenario_out_of_range, 2, "acceleration of Z of [axis]"},
      {"[machine]\nio_cards = [4]\n", scenario_out_of_range, 2, "1 to 3"},
      {"[machine]\nanalog = [0, 0, 0, 0, 0, 0, 0, 0, 0]\n", scenario_out_of_range, 1, "9 values"},
      {"[door]\nport = 17\n", scenario_out_of_range, 2, "no such port"},
      {"[machine]\nports_on = [1, 109]\n", scenario_out_of_range, 2, "no such port"},
      {"[link]\nloss = 1.01\n", scenario_out_of_range, 2, "0 to 1"},
      {"[[event]]\nat = -1\naction = \"cable_out\"\n", scenario_out_of_range, 2, "0 to 1000000 s"},
      {"[[event]]\nat = 1\naction = \"analog\"\ninput = 9\nvalue = 0\n", scenario_out_of_range, 4,
       "1 to 8"},
      {"[tool_setter]\nx = 1\ny = 1\n", scenario_key_missing, 1, "needs a value for top"},
      {"[[heater]]\npwm = 1\n", scenario_key_missing, 1, "analog"},
      {"[stock]\nx = 1\n", scenario_key_missing, 1, "needs a value for y"},
      {"[[event]]\nat = 1\n", scenario_key_missing, 1, "action"},
      {"[[event]]\naction = \"cable_out\"\n", scenario_key_missing, 1, "at, in seconds, or when"},
      {"[[event]]\nwhen = { axis = \"X\" }\naction = \"cable_out\"\n", scenario_key_missing, 2,
       "below"},
      {"[[event]]\nat = 1\naction = \"estop_pres\"\n", scenario_unknown_word, 3,
       "Is \"estop_press\" meant?"},
      {"[[event]]\nat = 1\naction = \"step_loss\"\naxis = \"x\"\nsteps = 3\n",
       scenario_unknown_word, 4, "Is \"X\" meant?"},
      {"[[event]]\nat = 1\naction = \"probe_stuck\"\nstate = \"closed\"\n", scenario_unknown_word,
       4, "\"on\", \"off\", \"free\""},
      {"[[event]]\nat = 1\nwhen = { axis = \"X\", beyond = 1 }\naction = \"cable_out\"\n",
       scenario_contradiction, 1, "either at"},
      {"[[event]]\nwhen = { axis = \"X\", beyond = 1, below = 0 }\naction = \"cable_out\"\n",
       scenario_contradiction, 2, "not both"},
      {"[machine]\nstop_margin = 1.5\n", scenario_contradiction, 1,
       "the hard stop is at stop_margin, 1.5"},
      {"[[tool]]\nnumber = 3\nlength = 1\n[[tool]]\nnumber = 3\nlength = 2\n",
       scenario_contradiction, 4, "Tool 3"},
      {"[axis.X]\ncorner_velocity = 5\ntop_velocity = 4\n", scenario_contradiction, 1,
       "top_velocity of 4"},
      {"[stock]\nheight = 5\nheights = [[1, 2], [3, 4]]\n", scenario_contradiction, 1,
       "one of them"},
  }));
  INFO(row.text);
  const Result<Scenario> result = parse_scenario(row.text, "test.toml");
  REQUIRE_FALSE(result);
  INFO(result.error().to_string());
  CHECK(result.error().code == row.code);
  REQUIRE(result.error().place);
  CHECK(result.error().place->file == "test.toml");
  CHECK(result.error().place->line == row.line);
  CHECK_THAT(result.error().message, Catch::Contains(row.says));
}

TEST_CASE("Of several errors the first one in the order of reading is told", "[hal][scenario]") {
  const Result<Scenario> result =
      parse_scenario("[machine]\nstop_margin = -1\nswitch_bounce = 5\n", "test.toml");
  REQUIRE_FALSE(result);
  CHECK(result.error().place->line == 2);
}

TEST_CASE("A scenario that is not there is an error", "[hal][scenario]") {
  const Result<Scenario> result = load_scenario(kExamples / "no_such_file.toml");
  REQUIRE_FALSE(result);
  CHECK(result.error().code == ErrorCode::file_not_found);
}

TEST_CASE("The shipped scenarios are right, and have events", "[hal][scenario]") {
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(kExamples)) {
    const Result<Scenario> result = load_scenario(file.path());
    INFO((result ? file.path().string() : result.error().to_string()));
    REQUIRE(result);
    CHECK_FALSE(result->events.empty());
    ++files;
  }
  CHECK(files == 3);
}

TEST_CASE("docs/scenarios.md has every key and every action", "[hal][scenario]") {
  std::stringstream page;
  page << std::ifstream(CNC_SOURCE_DIR "/docs/scenarios.md").rdbuf();
  const std::string text = page.str();
  // An unknown key or word is answered with all that there are.
  const auto told = [](const std::string& program, const std::regex& part) {
    const Result<Scenario> result = parse_scenario(program, "test.toml");
    REQUIRE_FALSE(result);
    std::smatch match;
    const std::string message = result.error().message;
    INFO(message);
    REQUIRE(std::regex_search(message, match, part));
    return match[1].str();
  };
  const auto names_in = [](const std::string& list) {
    std::set<std::string> names;
    const std::regex word("[a-z_]+");
    for (auto i = std::sregex_iterator(list.begin(), list.end(), word); i != std::sregex_iterator();
         ++i) {
      names.insert(i->str());
    }
    return names;
  };
  const std::string event = "[[event]]\nat = 1\nqqq = 1\naction = ";
  std::set<std::string> names =
      names_in(told(event + "\"qqq\"\n", std::regex("one of ([^.]*)\\.")));
  CHECK(names.size() == 20);
  const std::regex keys("It has: (.*)\\.");
  const std::set<std::string> actions = names;
  for (const std::string& action : actions) {
    // A missing key is told before an unknown one, so all that any action needs is there.
    const std::string all =
        "axis = \"X\"\nswitch = \"home\"\nstate = \"on\"\non = true\nsteps = 1\ninput = 1\n"
        "value = 0\nport = 1\ncounts = 1\nnumber = 1\n";
    names.merge(names_in(told(event + "\"" + action + "\"\n" + all, keys)));
  }
  for (const std::string table : {"[machine]", "[axis.X]", "[door]", "[spindle]", "[link]", ""}) {
    names.merge(names_in(told(table + "\nqqq = 1\n", keys)));
  }
  names.merge(names_in(told("[stock]\nheight = 1\nqqq = 1\n", keys)));
  names.merge(names_in(told("[tool_setter]\nx=0\ny=0\ntop=0\nqqq = 1\n", keys)));
  names.merge(names_in(told("[[tool]]\nnumber=1\nlength=0\nqqq = 1\n", keys)));
  names.merge(names_in(told("[[heater]]\npwm=1\nanalog=1\nqqq = 1\n", keys)));
  names.merge(
      names_in(told("[stock]\nx=0\ny=0\ndx=1\ndy=1\nheights=[[1,2],[3,4]]\nqqq = 1\n", keys)));
  CHECK(names.size() > 70);
  for (const std::string& name : names) {
    INFO(name);
    const bool as_key = text.find("`" + name) != std::string::npos;
    const bool as_table = text.find("[" + name) != std::string::npos;
    CHECK((as_key || as_table));
  }
}
