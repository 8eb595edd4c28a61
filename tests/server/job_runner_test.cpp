// What a JobRunner says of a planner that gives nothing.
#include "server/job/job_runner.h"

#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "motion/profile.h"
#include "server/job/settings.h"
#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;

namespace {

/// Takes every piece and never moves.
class Stuck final : public motion::Profile {
 public:
  [[nodiscard]] bool sufficient() const override { return !empty_; }
  [[nodiscard]] bool well_stocked() const override { return !empty_; }
  bool extend() override { return true; }
  void append(const motion::Piece& /*piece*/) override { empty_ = false; }
  void plan() override {}
  void stop_at_end() override {}
  void set_overrides(const motion::Overrides& /*overrides*/) override {}
  void clear() override { empty_ = true; }

  [[nodiscard]] bool empty() const override { return empty_; }
  [[nodiscard]] bool standing() const override { return true; }
  void prepare(bool /*held*/) override {}
  [[nodiscard]] std::optional<motion::Setpoint> next(bool /*held*/) override { return {}; }
  [[nodiscard]] std::optional<motion::Stretch> skip() override { return {}; }
  [[nodiscard]] Position position() const override { return {}; }
  [[nodiscard]] double time_to_end() const override { return 0.0; }

  [[nodiscard]] motion::ProfilePlace place() const override { return {}; }
  void go_back(const motion::ProfilePlace& /*place*/) override {}
  void forget_before(const motion::ProfilePlace& /*place*/) override {}
  [[nodiscard]] bool keeps_too_much(const motion::ProfilePlace& /*oldest*/) const override {
    return false;
  }
  [[nodiscard]] bool can_keep_more(const motion::ProfilePlace& /*oldest*/) const override {
    return true;
  }
  [[nodiscard]] bool can_go_on_alone() const override { return true; }
  void revert(const motion::ProfilePlace& /*place*/) override {}

 private:
  bool empty_ = true;
};

/// A job on a planner that never moves.
struct StuckJob {
  explicit StuckJob(const std::string& text)
      : interpreter(interpreter_settings(data.config), data.parameters, data.tools),
        planner(planner_settings(data.config), {}, std::make_unique<Stuck>()),
        runner(data.config, interpreter, planner) {
    runner.start(interp::Program::from_text(text, "job").value(), {});
  }

  /// What it comes to.
  JobRunner::Next outcome() {
    for (int i = 0; i < 1000; ++i) {
      const JobRunner::Next next = runner.next();
      if (next != JobRunner::Next::busy && next != JobRunner::Next::note) return next;
    }
    return JobRunner::Next::busy;
  }

  MachineData data = free_machine();
  interp::Interpreter interpreter;
  motion::Planner planner;
  JobRunner runner;
};

std::string moves(int count) {
  std::string text = "G1 F1000\n";
  for (int i = 1; i <= count; ++i) text += "X" + std::to_string(i) + "\n";
  return text;
}

}  // namespace

TEST_CASE("A planner that gives no motion ends the job with an error, not in silence",
          "[MOT-3][JOB-8]") {
  // All that there is; and so much that not all of it is read.
  const int count = GENERATE(1, 5000);
  CAPTURE(count);
  StuckJob job(moves(count));
  REQUIRE(job.outcome() == JobRunner::Next::failed);
  CHECK(job.runner.error().code == ErrorCode::motion_not_found);
}

TEST_CASE("Without motion a job is not at fault while it is held or an override is 0",
          "[MAN-8][JOB-8]") {
  StuckJob job(moves(1));
  SECTION("held") { job.runner.hold(); }
  SECTION("feed override 0") { job.planner.set_overrides(0.0, 1.0); }
  SECTION("rapid override 0") { job.planner.set_overrides(1.0, 0.0); }
  CHECK(job.outcome() == JobRunner::Next::held);
}
