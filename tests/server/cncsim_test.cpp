// cncsim as a process: examples, real programs, the recording, and what it answers to bad input.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/config/temporary_directory.h"
#include "tests/process.h"

using namespace cnc::test;
using Catch::Contains;
using cnc::config::test::content_of;
using cnc::config::test::put;
using cnc::config::test::TemporaryDirectory;
using nlohmann::json;

namespace {

// As the program's help says.
constexpr int kGood = 0;
constexpr int kJobFailed = 1;
constexpr int kBadInput = 2;

const std::string kExamples = std::string(CNC_SOURCE_DIR) + "/config/examples/";
const std::string kCorpus = std::string(CNC_SOURCE_DIR) + "/../shared/corpus/gcode/";

/// The part of a limit that may be exceeded: rounding of the plan and of its check.
constexpr double kRounding = 1e-6;

struct Axis {
  const char* name;
  double velocity;
  double acceleration;
};
// The shipped cnc.ini.
constexpr Axis kAxes[] = {
    {"X", 100.0, 500.0}, {"Y", 100.0, 500.0}, {"Z", 50.0, 300.0}, {"A", 90.0, 360.0}};

Outcome cncsim(std::vector<std::string> arguments) {
  const TemporaryDirectory folder;
  arguments.insert(arguments.begin(), CNCSIM);
  return Process(arguments, folder.file("cncsim").string()).wait();
}

/// A program as a file, and room for what cncsim writes.
struct ProgramFile {
  explicit ProgramFile(std::string_view text) { put(path(), text); }

  [[nodiscard]] std::string path() const { return folder.file("program.nc").string(); }
  TemporaryDirectory folder;
};

/// A machine with ten metres of travel and a fourth axis: room for any program.
std::vector<std::string> wide_machine() {
  std::vector<std::string> arguments{"--set", "AXIS_A.visible=1", "--set", "AXIS_A.port=4"};
  for (const char* axis : {"X", "Y", "Z"})
    for (const char* limit : {"negativeLimit=-5000", "positiveLimit=5000"}) {
      arguments.emplace_back("--set");
      arguments.push_back("AXIS_" + std::string(axis) + "." + limit);
    }
  return arguments;
}

json replay_json(const std::string& file, int expected) {
  const Outcome outcome = cncsim({"replay", file, "--json"});
  INFO(outcome.err << outcome.out);
  REQUIRE(outcome.exit_code == expected);
  return json::parse(outcome.out);
}

json run_json(const std::string& file, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"run", file, "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = cncsim(arguments);
  INFO(outcome.err << outcome.out);
  CHECK(outcome.exit_code == kGood);
  return json::parse(outcome.out);
}

void check_within_limits(const json& report) {
  CHECK(report["good"] == true);
  CHECK(report["errors"].empty());
  CHECK(report["job_time"] > 0.0);
  for (const Axis& axis : kAxes) {
    INFO(axis.name);
    CHECK(report["max_velocity"][axis.name] <= axis.velocity * (1.0 + kRounding));
    CHECK(report["max_acceleration"][axis.name] <= axis.acceleration * (1.0 + kRounding));
    CHECK(report["lost_steps"][axis.name] == 0);
  }
}

}  // namespace

TEST_CASE("The shipped examples run on the shipped machine", "[JOB-1][MOT-1]") {
  const std::string name =
      GENERATE("rounded_rectangle.ngc", "hole_pattern.ngc", "multi_plane_contour.ngc");
  INFO(name);
  check_within_limits(run_json(kExamples + name));
}

TEST_CASE("Real programs run to their end, exceed no limit and lose no step", "[JOB-1][MOT-1]") {
  if (!std::filesystem::exists(kCorpus)) {
    WARN("The corpus of real programs is not here: test skipped.");
    return;
  }
  const auto name =
      GENERATE(as<std::string>{},  //
               "nist--c1_hello_world.ngc", "nist--c2_expressions.ngc", "linuxcnc--Pasta.ngc",
               "linuxcnc--blur_torus.ngc", "linuxcnc--tort.ngc", "linuxcnc--wheels.ngc",
               "linuxcnc--zigzag_0.002_0.0005.ngc", "nraynaud--tux.ngc", "pcb2gcode--back.ngc",
               "CauldronDevelopmentLLC--botomata_bottom.nc",
               "CauldronDevelopmentLLC--flower_mold.nc", "CauldronDevelopmentLLC--tiger.nc",
               "SergeyPopovGit--ScalePanel.nc", "Sienci-Labs--FourAxisSurface_finishPass.nc",
               "bdring--arcs_arrows.nc", "winder--communicator.nc", "synthetos--FordEmblem.gcode",
               "winder--arc_rword_test.gcode", "winder--no_spaces.gcode", "fragmuffin--Skull2.tap");
  INFO(name);
  check_within_limits(run_json(kCorpus + name, wide_machine()));
}

TEST_CASE("Wrong programs of other people stop on the wrong line", "[LNG-10]") {
  if (!std::filesystem::exists(kCorpus)) {
    WARN("The corpus of real programs is not here: test skipped.");
    return;
  }
  struct Wrong {
    const char* file;
    int line;
    const char* name;
  };
  const auto [file, line, name] = GENERATE(values<Wrong>({
      {"Sienci-Labs--jsdc_with_error.gcode", 123, "axis_words_missing"},
      {"linuxcnc--bad-arc.medium.metric.ngc", 6, "arc_radius_mismatch"},
      {"linuxcnc--bad-no-feed-rate.ngc", 2, "feed_not_set"},
  }));
  INFO(file);
  std::vector<std::string> arguments{"run", kCorpus + file, "--json"};
  for (const std::string& setting : wide_machine()) arguments.push_back(setting);
  const Outcome outcome = cncsim(arguments);
  CHECK(outcome.exit_code == kJobFailed);
  const json report = json::parse(outcome.out);
  CHECK(report["good"] == false);
  REQUIRE(report["errors"].size() == 1);
  CHECK(report["errors"][0]["line"] == line);
  CHECK(report["errors"][0]["name"] == name);
}

TEST_CASE("The reported time is that of the motion", "[JOB-5]") {
  // From rest to rest: 100 mm at 20 mm/s with ramps of 500 mm/s²: s/v + v/a.
  const ProgramFile program("G53 G0 X0\nG91 G1 X100 F1200\nG4 P2\n");
  const json report = run_json(program.path());
  CHECK(report["job_time"].get<double>() ==
        Approx(100.0 / 20.0 + 20.0 / 500.0 + 2.0).epsilon(1e-4));
  CHECK(report["distance"].get<double>() == Approx(100.0));
  CHECK(report["max"]["X"].get<double>() == Approx(100.0));
}

TEST_CASE("What the interpreter takes for an arc the planner moves along", "[GCO-2]") {
  // The radii 999.5 and 1000.5 differ by a thousandth of the larger one: the most that is allowed.
  const ProgramFile program("G53 G0 X0 Y0\nG91 G2 X2000 I999.5 F60000\n");
  const json report = run_json(program.path(), wide_machine());
  CHECK(report["max"]["X"].get<double>() == Approx(2000.0));
}

TEST_CASE("A recording has a row per millisecond from rest to the end position", "[JOB-5]") {
  const ProgramFile program("G53 G0 X0 Y0 Z0\nG91 G1 X10 Y5 F600\n");
  const std::string file = program.folder.file("record.csv").string();
  const json report = run_json(program.path(), {"--record", file});
  std::istringstream rows(content_of(file));
  std::string row;
  REQUIRE(std::getline(rows, row));
  CHECK(row == "t,x,y,z,a,b,c,f,line");
  int count = 0;
  std::string last;
  double x_before = 0.0;
  while (std::getline(rows, row)) {
    CHECK(std::stod(row) == Approx(0.001 * count).margin(1e-9));
    const double x = std::stod(row.substr(row.find(',') + 1));
    // 10 mm/s along the path: X is at most 10 mm/s.
    CHECK(x - x_before <= 0.010 + 1e-6);
    CHECK(x >= x_before - 1e-9);
    x_before = x;
    last = row;
    ++count;
  }
  const double time = report["job_time"];
  CHECK(count == static_cast<int>(std::floor(time * 1000.0)) + 2);  // row 0, and the end's row
  CHECK_THAT(last, Contains(",10.000000000,5.000000000,0.000000000,") && Catch::EndsWith(",10,2"));
}

TEST_CASE("Simulating twice gives the same recording to the last digit", "[ARC-4]") {
  const ProgramFile program("G64\nG0 X10 Y10 Z5\nG2 X20 Y20 I10 F3000\nG1 X30\nG0 X0 Y0 Z0\n");
  const auto recording = [&](const char* name) {
    const std::string file = program.folder.file(name).string();
    run_json(program.path(), {"--record", file});
    return content_of(file);
  };
  CHECK(recording("first.csv") == recording("second.csv"));
}

TEST_CASE("An error in the middle of a program is an exit code and a place", "[LNG-10]") {
  struct Bad {
    const char* text;
    const char* message;
  };
  const auto [text, message] = GENERATE(values<Bad>({
      {"G1 X1 F100\nG77\n", "program.nc:2:1"},
      {"G53 G0 X1\nG53 G0 X601\n", "program.nc:2"},
      {"G53 G0 A5\n", "axis A, which is not connected"},
  }));
  INFO(text);
  const ProgramFile program(text);
  const Outcome outcome = cncsim({"run", program.path()});
  CHECK(outcome.exit_code == kJobFailed);
  CHECK_THAT(outcome.out, Contains(message) && Contains("STOPPED"));
}

TEST_CASE("Input that cannot be read is refused before anything runs", "[JOB-1][CFG-1]") {
  const ProgramFile good("G0 X1\n");
  const TemporaryDirectory folder;
  put(folder.file("empty.nc"), "");
  put(folder.file("binary.nc"), std::string_view("G0 X1\n\0\0\x7f"
                                                 "ELF",
                                                 12));
  put(folder.file("wrong.ini"), "[AXIS_X]\nport = 1\nspeed = 3\n");
  const auto at = [&](const char* name) { return folder.file(name).string(); };
  struct Bad {
    std::vector<std::string> arguments;
    const char* message;
  };
  const std::vector<Bad> rows{
      {{"run", at("missing.nc")}, "missing.nc"},
      {{"run", at("empty.nc")}, "E2001"},
      {{"run", at("binary.nc")}, "E2002"},
      {{"run", folder.path().string()}, "E10"},
      {{"run", good.path(), "--config", at("missing.ini")}, "missing.ini"},
      {{"run", good.path(), "--config", at("wrong.ini")}, "wrong.ini:3"},
      {{"run", good.path(), "--set", "AXIS_X.velocity=fast"}, "[AXIS_X] velocity"},
      {{"run", good.path(), "--parameters", at("missing.txt")}, "missing.txt"},
      {{"run", good.path(), "--tools", at("missing.txt")}, "missing.txt"},
      {{"run", good.path(), "--record", at("no/folder.csv")}, "no/folder.csv"},
      {{"run"}, "file"},
      {{"walk", good.path()}, "subcommand"},
      {{"check", at("missing.nc")}, "missing.nc"},
  };
  for (const Bad& row : rows) {
    const Outcome outcome = cncsim(row.arguments);
    INFO(row.message << "\n" << outcome.err);
    CHECK(outcome.exit_code == kBadInput);
    CHECK_THAT(outcome.err + outcome.out, Contains(row.message));
  }
}

TEST_CASE("A line that is too long is an error with its number", "[GCO-1]") {
  const ProgramFile program("G0 X1\n(" + std::string(5000, 'x') + ")\nG0 X2\n");
  const Outcome outcome = cncsim({"run", program.path()});
  CHECK(outcome.exit_code == kJobFailed);
  CHECK_THAT(outcome.out, Contains("program.nc:2") && Contains("E2100"));
}

TEST_CASE("check gives up a program without end, and names the option that lets it go on",
          "[JOB-2]") {
  const ProgramFile program("while [1]\nG0 X[1 - #5001]\nendwhile\n");
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--max-loop-lines", "1000"}}) {
    std::vector<std::string> arguments{"check", program.path()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = cncsim(arguments);
    CHECK(outcome.exit_code == kJobFailed);
    CHECK_THAT(outcome.out, Contains("E2601") && Contains("--max-loop-lines"));
    CHECK_THAT(outcome.out, Contains(more.empty() ? "10000000 lines" : "1000 lines"));
  }
}

TEST_CASE("Ctrl-C ends a check with its report", "[JOB-2]") {
  const ProgramFile program("G0 X1\nG77\nwhile [1]\nG0 X[1 - #5001]\nendwhile\n");
  const TemporaryDirectory folder;
  Process check({CNCSIM, "check", program.path(), "--max-loop-lines", "0", "--progress"},
                folder.path());
  REQUIRE(check.says("lines in loops and subs"));
  check.signal(SIGINT);
  const Outcome outcome = check.wait();
  CHECK(outcome.exit_code == kJobFailed);
  CHECK_THAT(outcome.out, Contains("program.nc:2") && Contains("interrupted"));
}

TEST_CASE("check lists every wrong line, and its JSON names each", "[JOB-2][LNG-10]") {
  const ProgramFile program("G0 X1\nG77\nG1 X2\nG0 X3\n");
  const Outcome text = cncsim({"check", program.path()});
  CHECK(text.exit_code == kJobFailed);
  CHECK_THAT(text.out, Contains("program.nc:2") && Contains("program.nc:3"));
  const Outcome machine = cncsim({"check", program.path(), "--json"});
  CHECK(machine.exit_code == kJobFailed);
  const json report = json::parse(machine.out);
  CHECK(report["good"] == false);
  CHECK(report["complete"] == true);
  REQUIRE(report["errors"].size() == 2);
  CHECK(report["errors"][0]["line"] == 2);
  CHECK(report["errors"][0]["name"] == "unknown_g_code");
  CHECK(report["errors"][1]["line"] == 3);
  CHECK(report["errors"][1]["name"] == "feed_not_set");
}

TEST_CASE("check writes the canonical commands of a good program", "[GCO-1]") {
  const ProgramFile program("G53 G0 X1\nM30\n");
  const std::string file = program.folder.file("canon.txt").string();
  CHECK(cncsim({"check", program.path(), "--canon", file}).exit_code == kGood);
  CHECK_THAT(content_of(file), Contains("STRAIGHT_TRAVERSE(1.000000, 0.000000, 0.000000") &&
                                   Contains("PROGRAM_END()"));
}

TEST_CASE("A name in another encoding does not spoil the JSON report", "[LNG-10]") {
  const ProgramFile program("(fr\xe4se)\nG0 X1 \xe4\n");
  const Outcome outcome = cncsim({"run", program.path(), "--json"});
  CHECK(outcome.exit_code == kJobFailed);
  CHECK(json::parse(outcome.out)["good"] == false);
}

TEST_CASE("cncsim runs jobs that probe, ask and use the macro file", "[LNG-4][LNG-6][GCO-8]") {
  const ProgramFile program(
      "G53 G0 X300 Y200\n"  // above the stock of the simulated machine
      "G53 G38.2 Z-140 F300\n"
      "msg \"touched \"#5067\" at \"#5053\n"
      "#1 = 7\n"
      "dlgmsg \"How far?\" \"X\" 1\n"
      "msg \"answer \"#5398\" \"#1\n"
      "gosub user_3\n"
      "G53 G0 Z0\n"
      "home z\n"
      "M30\n");
  const json report = run_json(program.path());
  check_within_limits(report);
  const std::string messages = report["messages"].dump();
  CHECK_THAT(messages, Contains("touched 1 at -86"));
  CHECK_THAT(messages, Contains("answer 1 7"));
  CHECK_THAT(messages, Contains("user_3 is free"));
  CHECK_THAT(messages, Contains("Axis Z is homed"));
}

TEST_CASE("cncsim replays the trace of a run and finds the same", "[cncsim][trace]") {
  const ProgramFile program("G1 X50 Y0 F3000\nG2 X70 Y20 I20\nG0 X0 Y0\nM30\n");
  const std::string trace = program.folder.file("run.trace").string();
  REQUIRE(cncsim({"run", program.path(), "--trace", trace}).exit_code == kGood);
  const json report = replay_json(trace, kGood);
  CHECK(report["reason"] == "asked_for");
  CHECK(report["replay"]["reproduced"] == true);
  CHECK(report["replay"]["largest_deviation"].get<double>() < 2.0 / 200.0);

  const std::string csv = program.folder.file("run.csv").string();
  const Outcome shown = cncsim({"replay", trace, "--last", "0.1", "--csv", csv});
  CHECK(shown.exit_code == kGood);
  // Cycles of 20 ms: six exchanges, the first and the last counted.
  CHECK_THAT(shown.out, Contains("REPRODUCED") && Contains("no fault") && Contains("-0.1000"));
  CHECK_THAT(shown.out, !Contains("-0.1200 running"));
  std::istringstream lines(content_of(csv));
  std::string head;
  std::getline(lines, head);
  CHECK_THAT(head, Contains("segments_sent,now,frame") && Contains(",status.position.X,"));
  std::size_t rows = 0;
  for (std::string line; std::getline(lines, line); ++rows)
    CHECK(std::ranges::count(line, ',') == std::ranges::count(head, ','));
  CHECK(rows == report["exchanges"]);
}

TEST_CASE("cncsim replays a fault and says which and when", "[cncsim][trace][LNK-4]") {
  const ProgramFile program("G1 X50 F3000\nX0\nM30\n");
  const std::string scenario = program.folder.file("estop.toml").string();
  put(scenario, "[[event]]\nwhen = { axis = \"X\", beyond = 20.0 }\naction = \"estop_press\"\n");
  const std::string trace = program.folder.file("run.trace").string();
  REQUIRE(cncsim({"run", program.path(), "--scenario", scenario, "--trace", trace}).exit_code ==
          kJobFailed);
  const json report = replay_json(trace, kGood);
  CHECK(report["replay"]["faults"][0]["faults"] == "estop");
  CHECK_THAT(cncsim({"replay", trace}).out, Contains("faults: estop"));
}

TEST_CASE("cncsim refuses what is no trace, and one that is not whole", "[cncsim][trace]") {
  const ProgramFile program("G0 X1\nM30\n");
  const Outcome none = cncsim({"replay", program.path()});
  CHECK(none.exit_code == kBadInput);
  CHECK_THAT(none.err, Contains("is no trace file") && Contains("E4201"));
  CHECK(cncsim({"replay", program.folder.file("missing").string()}).exit_code == kBadInput);

  const std::string trace = program.folder.file("run.trace").string();
  REQUIRE(cncsim({"run", program.path(), "--trace", trace}).exit_code == kGood);
  std::filesystem::resize_file(trace, std::filesystem::file_size(trace) - 100);
  const Outcome cut = cncsim({"replay", trace});
  CHECK(cut.exit_code == kBadInput);
  CHECK_THAT(cut.err, Contains("ends in the middle") && Contains("E4202"));
  CHECK_THAT(cncsim({"replay", "--help"}).out, Contains("--last") && Contains("--csv"));
}
