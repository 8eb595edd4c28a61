// cncctl as a process beside a fake server, for the tests that look at it from outside.
#pragma once

#include <string>
#include <vector>

#include "tests/api/fake_server.h"
#include "tests/process.h"

namespace cnc::test {

// As documented in docs/cncctl.md.
inline constexpr int kOk = 0;
inline constexpr int kRefused = 1;
inline constexpr int kUsage = 2;
inline constexpr int kNoServer = 3;
inline constexpr int kIncompatible = 4;
inline constexpr int kInterrupted = 130;

/// cncctl with a fake server of its own.
struct CtlFixture {
  TemporaryFolder folder;
  FakeMachine machine;
  FakeServer server{machine, folder.socket()};

  [[nodiscard]] Process start(std::vector<std::string> arguments,
                              const std::string& input = "/dev/null") const {
    arguments.insert(arguments.begin(), {CNCCTL, "--server", server.address()});
    return {arguments, folder.file("cncctl").string(), input};
  }
  [[nodiscard]] Outcome run(const std::vector<std::string>& arguments) const {
    return start(arguments).wait();
  }
};

inline Outcome run_alone(std::vector<std::string> arguments) {
  const TemporaryFolder folder;
  arguments.insert(arguments.begin(), CNCCTL);
  return Process(arguments, folder.file("cncctl").string()).wait();
}

inline void refuse(CtlFixture& f, const std::string& call) {
  f.machine.change([&](FakeMachine& m) {
    m.failures[call] =
        failure(grpc::StatusCode::FAILED_PRECONDITION,
                error_detail(5001, "command_not_allowed", "The drives are off.", "cncctl reset."));
  });
}

/// A job of ten lines that is running, and that ends as the test says once it has been seen.
inline void start_job(FakeMachine& m) {
  m.status.set_state(v1::MACHINE_STATE_RUNNING);
  m.status.mutable_job()->set_path("/jobs/a.nc");
  m.status.mutable_job()->set_lines(10);
  m.status.mutable_job()->set_line(5);
  m.status.mutable_job()->set_progress(0.5);
  m.status.mutable_job()->set_elapsed(61.0);
  m.status.mutable_job()->set_prediction_ready(true);
  m.status.mutable_job()->set_predicted_time(122.0);
  m.status.mutable_job()->set_time_left(61.0);
}

inline void end_job(FakeMachine& m, bool ended_well) {
  m.status.set_state(v1::MACHINE_STATE_READY);
  m.status.mutable_job()->set_runs(m.status.job().runs() + 1);
  m.status.mutable_job()->set_ended_well(ended_well);
  m.status.mutable_job()->set_elapsed(123.0);
}

}  // namespace cnc::test
