// The predicted time of a job is the time that it takes (JOB-5).
#include "server/job/prediction.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/core.h>
#include <future>
#include <map>
#include <stop_token>

#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

const std::string kExamples = std::string(CNC_SOURCE_DIR) + "/config/examples/";

/// G54 as the shipped parameters have it, so that the examples stay within the limits.
MachineData machine_for_examples() {
  MachineData data = free_machine();
  Position offset;
  offset[Axis::X] = offset[Axis::Y] = 100.0;
  offset[Axis::Z] = -90.0;
  data.parameters.set_work_offset(1, offset);
  return data;
}

/// So many short moves that end at X5 Y5.
std::string zigzag(int moves) {
  std::string text;
  for (int i = 1; i < moves; ++i)
    text += fmt::format("G1 X{:.3f} Y{:.3f}\n", 5.0 + 0.3 * i, 5.0 + std::abs(i % 20 - 10) * 0.2);
  return text + "G1 X5 Y5\n";
}

Prediction prediction_of(const MachineData& data, std::shared_ptr<const interp::Program> program) {
  auto prediction =
      predict({data.config, std::move(program), data.parameters, data.tools, Position{}}, {});
  REQUIRE(prediction.has_value());
  return std::move(*prediction);
}

/// Resumes whatever the program waits for.
void run_with_prompts(Rig& rig) {
  REQUIRE(rig.becomes(
      [&] {
        if (rig.state() == State::tool_change || rig.state() == State::program_stop)
          REQUIRE(rig.machine.resume());
        return rig.state() == State::ready;
      },
      3600.0));
}

/// Of the analysis in the background: real time passes on its thread only.
std::shared_ptr<const JobFindings> findings_of(Rig& rig) {
  for (int i = 0; i < 2000 && !rig.machine.findings(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    rig.simulation.cycle();
  }
  REQUIRE(rig.machine.findings());
  return rig.machine.findings();
}

}  // namespace

TEST_CASE("The prediction of an example is the time of its run", "[JOB-5]") {
  const std::string name =
      GENERATE("rounded_rectangle.ngc", "hole_pattern.ngc", "multi_plane_contour.ngc");
  INFO(name);
  const auto program = interp::Program::open(kExamples + name);
  REQUIRE(program);
  const Prediction prediction = prediction_of(machine_for_examples(), *program);
  CHECK_FALSE(prediction.error);

  ReadyRig rig(machine_for_examples());
  double time = 0.0;
  rig.machine.set_setpoint_listener(
      [&](const motion::Setpoint& setpoint) { time += setpoint.duration; });
  REQUIRE(rig.machine.load(*program, name));
  REQUIRE(rig.machine.run());
  run_with_prompts(rig);
  CHECK(rig.shown()->job.ended_well);
  CHECK(time > 5.0);
  CHECK(time ==
        Approx(prediction.time()).margin(rig.machine.config().trajectory.interpolation_time));
}

TEST_CASE("The prediction of a smoothed path is the time of its run to the tick",
          "[JOB-5][MOT-2]") {
  std::string text = "G64 P0.02 Q0.001\nG0 X10 Y10 Z-1\nF3000\n";
  for (int i = 1; i <= 400; ++i) {
    text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", 10.0 + 0.2 * i,
                        12.0 + 3.0 * std::sin(0.11 * i), -1.0 - 0.8 * std::cos(0.37 * i));
    if (i % 100 == 0) text += fmt::format("G2 X{:.3f} Y12 I5 J0\nG4 P0.1\n", 20.0 + 0.2 * i);
  }
  const auto program = interp::Program::from_text(text, "smooth.nc");
  REQUIRE(program);
  const Prediction prediction = prediction_of(machine_for_examples(), *program);
  ReadyRig rig(machine_for_examples());
  double time = 0.0;
  rig.machine.set_setpoint_listener(
      [&](const motion::Setpoint& setpoint) { time += setpoint.duration; });
  REQUIRE(rig.machine.load(*program, "smooth.nc"));
  REQUIRE(rig.machine.run());
  run_with_prompts(rig);
  CHECK(time ==
        Approx(prediction.time()).margin(rig.machine.config().trajectory.interpolation_time));
}

TEST_CASE("Moves end in the run when the prediction says", "[JOB-5]") {
  struct Row {
    const char* rule;
    std::vector<std::string> settings;
    std::string program;
  };
  std::string notes = "G64 P0.02 F3000\nG1 X5\nG1 X10 Y2\n";
  for (int i = 0; i < 1500; ++i) notes += fmt::format("S{}\n", 100 + i % 7);
  const Row row = GENERATE_COPY(values<Row>({
      {"exact path with corners that are blended", {}, "F3000\nG1 X10\nX20 Y1\nX30\nY10\n"},
      {"exact stop", {}, "G61.1 F3000\nG1 X10\nX20\nX30\n"},
      {"exact stop of a move that vanishes", {}, "F3000\nG1 X10\nG61.1 G1 X10\nG61 G1 X20\n"},
      {"a spindle that runs up on a straight way",
       {"SPINDLE_0.spindleRampUpTime=0.5"},
       "F3000\nG1 X10\nM3 S1000\nG1 X20\nM5\nX30\n"},
      {"dwells and an output in a smoothed path",
       {},
       "G64 P0.1 F3000\n" + zigzag(40) + "G4 P0.2\n" + zigzag(40) + "M54 P1\n" + zigzag(300) +
           "G4 P0.003\n"},
      {"a dwell before everything else", {}, "G4 P0.1\nG1 X10 F600\n"},
      {"nothing but dwells", {}, "G4 P0.1\nG4 P0.2\nM8\nG4 P0\n"},
      {"a path that many notes keep open", {}, notes + "G1 X20 Y3\n"},
      {"limits of jerk",
       {"AXIS_X.jerk=20000", "AXIS_Y.jerk=20000", "AXIS_Z.jerk=20000"},
       "G64 P0.05 F3000\n" + zigzag(150) + "G4 P0.1\nG0 X5 Y5\n"},
  }));
  INFO(row.rule);
  const auto program = interp::Program::from_text(row.program, "moves.nc");
  REQUIRE(program);
  const MachineData data = free_machine(row.settings);
  const Prediction prediction = prediction_of(data, *program);
  CHECK_FALSE(prediction.error);

  ReadyRig rig(free_machine(row.settings));
  std::map<std::uint64_t, double> ends;
  double time = 0.0;
  rig.machine.set_setpoint_listener([&](const motion::Setpoint& setpoint) {
    time += setpoint.duration;
    ends[setpoint.tag.id] = time;
  });
  REQUIRE(rig.machine.load(*program, "moves.nc"));
  REQUIRE(rig.machine.run());
  run_with_prompts(rig);
  CHECK(rig.shown()->job.ended_well);
  const double tick = rig.machine.config().trajectory.interpolation_time;
  CHECK(prediction.time() > 0.0);
  CHECK(prediction.time() == Approx(time).margin(tick));
  // A setpoint may begin in one move and end in the next one.
  for (const auto& [move, end] : ends) CHECK(prediction.time_at(move) == Approx(end).margin(tick));
}

TEST_CASE("A prediction ends where the run would end with an error", "[JOB-2][JOB-5]") {
  const MachineData data = free_machine();
  const auto program = interp::Program::from_text("G1 X10 F600\nG1 X900\n", "test.nc");
  REQUIRE(program);
  const Prediction prediction = prediction_of(data, *program);
  REQUIRE(prediction.error);
  CHECK(prediction.error->code == ErrorCode::travel_limit);
  CHECK(prediction.error->place->line == 2);
  // 10 mm at 10 mm/s and the ramps, v/a = 10/500 s.
  CHECK(prediction.time() == Approx(1.0 + 0.02).epsilon(1e-3));
}

TEST_CASE("The time at the end of a move is the sum of the moves before it", "[JOB-5]") {
  const MachineData data = free_machine();
  const auto program =
      interp::Program::from_text("G61.1\nG1 X10 F600\nG1 X20\nG1 X30\n", "test.nc");
  REQUIRE(program);
  const Prediction prediction = prediction_of(data, *program);
  // Each move from rest to rest: 10 mm at 10 mm/s, v/a = 10/500 s of ramps.
  for (std::uint64_t move = 1; move <= 3; ++move)
    CHECK(prediction.time_at(move) == Approx(static_cast<double>(move) * 1.02).epsilon(1e-3));
  CHECK(prediction.time_at(0) == 0.0);
  CHECK(prediction.time_at(1000) == prediction.time());
}

TEST_CASE("A very long job's marks stay few and ascending", "[JOB-5][JOB-6]") {
  Prediction prediction;
  constexpr std::uint64_t kMoves = 1'000'000;
  for (std::uint64_t move = 1; move <= kMoves; ++move) prediction.add(0.001, move);
  CHECK(prediction.time() == Approx(0.001 * kMoves));
  double before = 0.0;
  for (std::uint64_t move = 0; move <= kMoves; move += 999) {
    const double time = prediction.time_at(move);
    CHECK(time >= before);
    // A ten-thousandth of the job is 100 moves, 0.1 s.
    CHECK(std::abs(time - 0.001 * static_cast<double>(move)) <= 0.1);
    before = time;
  }
}

TEST_CASE("A prediction that is not wanted any more ends", "[JOB-5]") {
  const MachineData data = free_machine();
  const auto program =
      interp::Program::from_text("while [1 == 1]\nG1 X1 F600\nG1 X0\nendwhile\n", "test.nc");
  REQUIRE(program);
  std::stop_source stop;
  stop.request_stop();
  CHECK_FALSE(predict({data.config, *program, data.parameters, data.tools, {}}, stop.get_token()));
}

TEST_CASE("A prediction ends wherever its two threads wait for each other", "[JOB-5][threads]") {
  struct Row {
    const char* rule;
    std::vector<std::string> settings;
    const char* program;
  };
  const Row row = GENERATE(values<Row>({
      {"times take longer than moves: the queue is full",
       {"AXIS_X.jerk=20000", "AXIS_Y.jerk=20000", "AXIS_Z.jerk=20000"},
       "G64 P0.02 F3000\nwhile [1 == 1]\nG1 X1\nG1 X2 Y1\nG1 X3\nG1 X2 Y0\nendwhile\n"},
      {"no moves come: the queue is empty", {}, "while [1 == 1]\n#100 = [#100 + 1]\nendwhile\n"},
      {"rests only", {}, "while [1 == 1]\nG4 P0\nendwhile\n"},
  }));
  INFO(row.rule);
  const MachineData data = free_machine(row.settings);
  const auto program = interp::Program::from_text(row.program, "endless.nc");
  REQUIRE(program);
  std::stop_source stop;
  auto predicted = std::async(std::launch::async, [&] {
    return predict({data.config, *program, data.parameters, data.tools, {}}, stop.get_token());
  });
  CHECK(predicted.wait_for(std::chrono::milliseconds(100)) == std::future_status::timeout);
  stop.request_stop();
  REQUIRE(predicted.wait_for(std::chrono::seconds(10)) == std::future_status::ready);
  CHECK_FALSE(predicted.get());
}

TEST_CASE("A job is predicted with the modes that it finds, those behind another job too",
          "[JOB-2][JOB-5][threads]") {
  MachineData data = free_machine();
  data.analyse_jobs = true;
  ReadyRig rig(std::move(data));
  REQUIRE(rig.mdi("G64 P0.2 F3000 G1 X5 Y5"));
  const auto program = interp::Program::from_text("G1 X20\nY20\nX5\nY5\nG61 F1500\n", "test.nc");
  REQUIRE(program);
  REQUIRE(rig.machine.load(*program, "test.nc"));
  for (const double feed : {50.0, 25.0}) {
    const auto findings = findings_of(rig);
    CHECK(findings->problem_count() == 0);
    CHECK(findings->prediction.time() > 60.0 / feed);
    REQUIRE(rig.machine.run());
    REQUIRE(rig.becomes(State::ready));
    CHECK(rig.shown()->job.elapsed == Approx(findings->prediction.time()).margin(0.15));
  }
}

TEST_CASE("What is wrong with a job is told when it is loaded, not each time that it is looked at",
          "[JOB-2][threads]") {
  MachineData data = free_machine();
  data.analyse_jobs = true;
  ReadyRig rig(std::move(data));
  const auto warnings = [&] {
    const auto messages = rig.simulation.log().after(0);
    return std::ranges::count_if(messages, [](const LogMessage& message) {
      return message.text.find("would stop with an error") != std::string::npos;
    });
  };
  REQUIRE(rig.load("G1 X10 F6000\nG77\n"));
  static_cast<void>(findings_of(rig));
  CHECK(warnings() == 1);
  REQUIRE(rig.machine.run());
  REQUIRE(rig.becomes([&] { return rig.shown()->job.runs == 1; }));
  static_cast<void>(findings_of(rig));
  CHECK(warnings() == 1);
  REQUIRE(rig.load("G1 X10 F6000\nG77\n"));
  static_cast<void>(findings_of(rig));
  CHECK(warnings() == 2);
}

TEST_CASE("A loaded job is checked and predicted in the background", "[JOB-2][JOB-5][threads]") {
  MachineData data = free_machine();
  data.analyse_jobs = true;
  ReadyRig rig(std::move(data));
  REQUIRE(rig.load("G1 X10 F600\nG1 X20 G77\n"));
  const auto findings = findings_of(rig);
  CHECK(rig.shown()->job.prediction_ready);
  CHECK(rig.shown()->job.problems == 1);
  CHECK(rig.shown()->job.extents_max[Axis::X] == Approx(10.0));
  REQUIRE(findings->report.errors.size() == 1);
  CHECK(findings->report.errors[0].line == 2);
}
