// Calls: what is asked arrives, what is answered comes back, and failures are explained.
#include "api/client.h"

#include <catch2/catch.hpp>
#include <future>
#include <stdlib.h>
#include <stop_token>
#include <unistd.h>

#include "tests/api/fake_server.h"

namespace cnc::test {
namespace {

using api::Axis;
using api::Client;
using api::ErrorKind;

struct Fixture {
  TemporaryFolder folder;
  FakeMachine machine;
  FakeServer server{machine, folder.socket()};

  [[nodiscard]] Client connected() const {
    auto client = Client::connect(server.address());
    REQUIRE(client.has_value());
    return std::move(*client);
  }
};

/// Restores an environment variable.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* before = getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST_CASE("Without a word the server is looked for in CNC_SERVER, the runtime folder, then /tmp",
          "[api][ARC-3]") {
  const TemporaryFolder folder;
  {
    const Environment variable("CNC_SERVER", "machine:1234");
    CHECK(api::default_address() == "machine:1234");
  }
  const Environment none("CNC_SERVER", "");
  {
    const Environment runtime("XDG_RUNTIME_DIR", folder.path().string());
    CHECK(api::default_address() == "unix://" + folder.file("cncserver.sock").string());
  }
  const Environment missing("XDG_RUNTIME_DIR", folder.file("missing").string());
  CHECK(api::default_address() == "unix:///tmp/cncserver-" + std::to_string(getuid()) + ".sock");
}

TEST_CASE("A client connects by unix socket and by TCP", "[api][ARC-1]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  const std::string address = GENERATE_REF(folder.socket(), std::string("127.0.0.1:0"));
  const FakeServer server(machine, address);
  const auto client = Client::connect(server.address());
  REQUIRE(client.has_value());
  CHECK(client->is_local() == address.starts_with("unix:"));
  const auto version = client->version();
  REQUIRE(version.has_value());
  CHECK(version->server == "9.8.7");
  CHECK(version->controller == "a fake board");
}

TEST_CASE("A server of another major API version is refused with both versions", "[api][ARC-3]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.api_major = 2; });
  const auto client = Client::connect(f.server.address());
  REQUIRE_FALSE(client.has_value());
  CHECK(client.error().kind == ErrorKind::incompatible);
  CHECK(client.error().name == "api_version_mismatch");
  CHECK_THAT(client.error().message,
             Catch::Contains("version 1.0") && Catch::Contains("version 2.4"));
}

TEST_CASE("Nobody at the address is an error at once that names the address", "[api]") {
  const TemporaryFolder folder;
  const auto client = Client::connect(folder.socket());
  REQUIRE_FALSE(client.has_value());
  CHECK(client.error().kind == ErrorKind::unavailable);
  CHECK(client.error().code == 6001);
  CHECK_THAT(client.error().message, Catch::Contains(folder.socket()));
}

TEST_CASE("A refusal carries the server's code, name, sentence and advice", "[api]") {
  Fixture f;
  const v1::ErrorDetail detail =
      error_detail(5001, "command_not_allowed", "Run needs a loaded job.", "Load a program first.");
  f.machine.change([&](FakeMachine& m) {
    m.failures["Run"] = failure(grpc::StatusCode::FAILED_PRECONDITION, detail);
  });
  const auto result = f.connected().run();
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error() == api::Error{.kind = ErrorKind::refused,
                                     .code = 5001,
                                     .name = "command_not_allowed",
                                     .message = "Run needs a loaded job.",
                                     .check = "Load a program first."});
  CHECK(result.error().to_string() == "Run needs a loaded job. [E5001]");
}

TEST_CASE("An error in a text says where", "[api]") {
  Fixture f;
  v1::ErrorDetail detail = error_detail(2001, "bad_word", "The word Q is not allowed here.", "");
  detail.mutable_place()->set_line(1);
  detail.mutable_place()->set_column(4);
  f.machine.change([&](FakeMachine& m) {
    m.failures["Execute"] = failure(grpc::StatusCode::INVALID_ARGUMENT, detail);
  });
  const auto result = f.connected().mdi("G1 Q5");
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().kind == ErrorKind::invalid);
  REQUIRE(result.error().place.has_value());
  CHECK(*result.error().place == api::TextPlace{"", 1, 4});
}

TEST_CASE("Every kind of gRPC status has its kind of error", "[api]") {
  Fixture f;
  const auto [code, kind] = GENERATE(table<grpc::StatusCode, ErrorKind>({
      {grpc::StatusCode::FAILED_PRECONDITION, ErrorKind::refused},
      {grpc::StatusCode::INVALID_ARGUMENT, ErrorKind::invalid},
      {grpc::StatusCode::OUT_OF_RANGE, ErrorKind::invalid},
      {grpc::StatusCode::NOT_FOUND, ErrorKind::invalid},
      {grpc::StatusCode::ABORTED, ErrorKind::failed},
      {grpc::StatusCode::INTERNAL, ErrorKind::failed},
      {grpc::StatusCode::UNAVAILABLE, ErrorKind::unavailable},
      {grpc::StatusCode::DEADLINE_EXCEEDED, ErrorKind::timed_out},
      {grpc::StatusCode::UNIMPLEMENTED, ErrorKind::unsupported},
      {grpc::StatusCode::PERMISSION_DENIED, ErrorKind::denied},
      // Not cancelled by us: the server goes down.
      {grpc::StatusCode::CANCELLED, ErrorKind::unavailable},
  }));
  f.machine.change([&](FakeMachine& m) { m.failures["Reset"] = grpc::Status(code, "because"); });
  const auto result = f.connected().reset();
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().kind == kind);
  CHECK_FALSE(result.error().message.empty());
}

TEST_CASE("A call that is not answered ends at its deadline", "[api]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.hold_motion = true; });
  api::ClientOptions options;
  options.motion_timeout = std::chrono::milliseconds(50);
  const auto client = Client::connect(f.server.address(), options);
  REQUIRE(client.has_value());
  const auto result = client->mdi("G4 P100");
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().kind == ErrorKind::timed_out);
  CHECK(f.machine.becomes([](FakeMachine& m) { return m.cancelled_calls == 1; }));
}

TEST_CASE("What moves is cancelled by its stop token, and the server is told", "[api]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.hold_motion = true; });
  const Client client = f.connected();
  std::stop_source stop;
  using Move = std::function<api::Result<void>(const Client&, std::stop_token)>;
  const auto [expected, move] = GENERATE(table<std::string, Move>({
      {"Home AXIS_X AXIS_Z ",
       [](const Client& c, auto s) {
         return c.home({Axis::X, Axis::Z}, s);
       }},
      {"Execute G0 X1", [](const Client& c, auto s) { return c.mdi("G0 X1", s); }},
      {"RunSub user_1", [](const Client& c, auto s) { return c.run_sub("user_1", s); }},
  }));
  auto call =
      std::async(std::launch::async, [&, &move = move] { return move(client, stop.get_token()); });
  REQUIRE(f.machine.becomes([&expected = expected](FakeMachine& m) { return m.saw(expected); }));
  stop.request_stop();
  const auto result = call.get();
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().kind == ErrorKind::cancelled);
  CHECK(result.error().code == 6004);
  CHECK(f.machine.becomes([](FakeMachine& m) { return m.cancelled_calls == 1; }));
}

TEST_CASE("A call whose stop token was requested before does not move the machine", "[api]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.hold_motion = true; });
  std::stop_source stop;
  stop.request_stop();
  const auto result = f.connected().home({}, stop.get_token());
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().kind == ErrorKind::cancelled);
}

TEST_CASE("Commands arrive with their arguments", "[api]") {
  Fixture f;
  const Client client = f.connected();
  REQUIRE(client.reset());
  REQUIRE(client.home());
  REQUIRE(client.jog_step(Axis::Y, -2.5, 0.25));
  REQUIRE(client.jog_stop());
  REQUIRE(client.set_work_zero({{Axis::X, 0.0}, {Axis::C, 90.5}}));
  REQUIRE(client.accept_position({Axis::Z}));
  REQUIRE(client.simulate_estop(true));
  REQUIRE(client.run());
  REQUIRE(client.pause());
  REQUIRE(client.resume());
  REQUIRE(client.stop());
  REQUIRE(client.rewind());
  REQUIRE(client.run_sub("user_3"));
  REQUIRE(client.answer(7, true, {1.5, -2.0}));
  REQUIRE(client.answer(8, true));
  REQUIRE(client.answer(9, false));
  const std::vector<std::string> expected{"GetVersion",
                                          "Reset",
                                          "Home",
                                          "Step AXIS_Y -2.5 0.25",
                                          "JogStop",
                                          "SetWorkZero AXIS_X=0 AXIS_C=90.5 ",
                                          "AcceptPosition AXIS_Z ",
                                          "SimulateEstop pressed",
                                          "Run",
                                          "Pause",
                                          "Resume",
                                          "Stop",
                                          "Rewind",
                                          "RunSub user_3",
                                          "Answer 7 OK 1.5 -2",
                                          "Answer 8 OK ",
                                          "Answer 9 Cancel "};
  const std::lock_guard lock(f.machine.mutex);
  CHECK(f.machine.calls == expected);
}

TEST_CASE("Only the overrides that are given are sent", "[api][MAN-8]") {
  Fixture f;
  const auto overrides = f.connected().set_overrides({.feed = 1.5, .speed = 0.75});
  REQUIRE(overrides.has_value());
  CHECK(f.machine.has_seen("SetOverrides feed=1.5 speed=0.75 "));
  CHECK(overrides->feed == 1.5);
  CHECK(overrides->rapid == 1.0);
  CHECK(overrides->speed == 0.75);
}

TEST_CASE("A status comes across with every field", "[api][ARC-1]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) {
    m.status.set_state(v1::MACHINE_STATE_TOOL_CHANGE);
    m.status.set_state_text("Insert tool 4.");
    m.status.mutable_machine_position()->set_x(1.25);
    m.status.mutable_work_position()->set_c(-90.0);
    m.status.add_homed(v1::AXIS_Z);
    m.status.mutable_trust()->set_z(v1::POSITION_TRUST_TRUSTED);
    m.status.mutable_trust()->set_y(v1::POSITION_TRUST_DOUBTFUL);
    m.status.set_feed(12.5);
    m.status.set_spindle(v1::SPINDLE_DIRECTION_COUNTERCLOCKWISE);
    m.status.set_work_system(9);
    m.status.mutable_job()->set_path("/jobs/a.nc");
    m.status.mutable_job()->set_runs(3);
    v1::CommandAvailability& resume = *m.status.add_commands();
    resume.set_command(v1::COMMAND_RESUME);
    resume.set_allowed(true);
    v1::CommandAvailability& jog = *m.status.add_commands();
    jog.set_command(v1::COMMAND_JOG);
    jog.set_reason("A job runs.");
  });
  const auto status = f.connected().status();
  REQUIRE(status.has_value());
  CHECK(status->state == api::MachineState::tool_change);
  CHECK(status->state_text == "Insert tool 4.");
  CHECK(status->machine_position[Axis::X] == 1.25);
  CHECK(status->work_position[Axis::C] == -90.0);
  CHECK(status->homed[Axis::Z]);
  CHECK_FALSE(status->homed[Axis::X]);
  CHECK(status->trust[Axis::Z] == api::PositionTrust::trusted);
  CHECK(status->trust[Axis::Y] == api::PositionTrust::doubtful);
  CHECK(status->trust[Axis::X] == api::PositionTrust::unknown);  // nothing was said of it
  CHECK(status->feed == 12.5);
  CHECK(status->spindle == api::SpindleDirection::counterclockwise);
  CHECK(status->work_system == 9);
  CHECK(status->job.path == "/jobs/a.nc");
  CHECK(status->job.runs == 3);
  CHECK(status->availability(api::Command::resume).allowed);
  CHECK_FALSE(status->availability(api::Command::jog).allowed);
  CHECK(status->availability(api::Command::jog).reason == "A job runs.");
  // Nothing was said about this one.
  CHECK_FALSE(status->availability(api::Command::run).allowed);
}

TEST_CASE("What a program asks comes with the status, and its answer may be refused",
          "[api][LNG-4]") {
  Fixture f;
  const v1::ErrorDetail detail =
      error_detail(5019, "no_question", "This question is not asked any more.", "The status.");
  f.machine.change([&](FakeMachine& m) {
    m.status.set_state(v1::MACHINE_STATE_QUESTION);
    m.status.set_probe_input(true);
    v1::Question& question = *m.status.mutable_question();
    question.set_number(3);
    question.set_title("How deep?");
    v1::QuestionField& field = *question.add_fields();
    field.set_label("Depth");
    field.set_parameter(101);
    field.set_value(2.5);
    m.failures["Answer"] = failure(grpc::StatusCode::FAILED_PRECONDITION, detail);
  });
  const Client client = f.connected();
  const auto status = client.status();
  REQUIRE(status.has_value());
  CHECK(status->state == api::MachineState::question);
  CHECK(status->probe_input);
  CHECK(status->question == api::Question{3, "How deep?", {{"Depth", 101, 2.5}}});
  const auto answer = client.answer(2, true, {3.0});
  REQUIRE_FALSE(answer.has_value());
  CHECK(answer.error().kind == ErrorKind::refused);
  CHECK(answer.error().name == "no_question");

  f.machine.change([](FakeMachine& m) { m.status.clear_question(); });
  CHECK_FALSE(client.status()->question.has_value());
}

TEST_CASE("A state of a newer server is unknown, not another state", "[api][ARC-3]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.status.set_state(static_cast<v1::MachineState>(99)); });
  const auto status = f.connected().status();
  REQUIRE(status.has_value());
  CHECK(status->state == api::MachineState::unknown);
}

TEST_CASE("The machine, its link and its program are described", "[api]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) {
    v1::Problem& problem = m.problems.emplace_back();
    *problem.mutable_error() = error_detail(2007, "arc_radius", "R is too small.", "The word R.");
    problem.mutable_error()->mutable_place()->set_line(17);
    problem.set_line_text("G2 X1 R0.1");
    problem.set_length(4);
    v1::CallSite& call = *problem.add_calls();
    call.set_sub("pocket");
    call.mutable_place()->set_file("part.nc");
    call.mutable_place()->set_line(3);
  });
  const Client client = f.connected();
  const auto machine = client.machine();
  REQUIRE(machine.has_value());
  REQUIRE(machine->axes.size() == 3);
  CHECK(machine->axes[2].axis == Axis::Z);
  CHECK(machine->axes[2].positive_limit == 303.0);
  CHECK(machine->homing_mandatory);
  CHECK(machine->picture_folder == "/data/dialogPictures");

  const auto link = client.link_statistics(true);
  REQUIRE(link.has_value());
  CHECK(link->cycles == 1000);
  CHECK(link->lateness.at(0).count == 7);
  CHECK(link->fifo_time.at(2).upper == 0.15);
  CHECK(link->fifo_time.at(2).count == 3);
  CHECK(link->mean_round_trip == 0.0004);
  CHECK(link->max_round_trip == 0.012);
  CHECK(link->packets.resent == 3);
  CHECK(link->packets.answered == 1990);
  CHECK(link->packets.corrupted == 5);
  CHECK(link->connected);
  CHECK(link->sessions == 2);
  CHECK(link->board_name == "a fake board");
  CHECK(link->board_serial == 77);
  REQUIRE(link->latches.size() == 3);
  CHECK(link->latches[0].source == api::LatchSource::home);
  CHECK(link->latches[0].axis == Axis::Y);
  CHECK(link->latches[0].age == 61.5);
  CHECK(link->latches[1].source == api::LatchSource::estop);
  CHECK_FALSE(link->latches[1].axis);
  CHECK(link->latches[1].count == 3);
  CHECK(link->latches[1].position[Axis::Z] == -4.0);
  CHECK(link->latches[2].source == api::LatchSource::unknown);
  CHECK(client.save_link_trace() == "/data/traces/now.trace");
  CHECK(f.machine.has_seen("GetLinkStatistics reset"));

  const auto text = client.read_lines(5, 2);
  REQUIRE(text.has_value());
  CHECK(text->first == 5);
  CHECK(text->lines == std::vector<std::string>{"N5", "N6"});

  const auto problems = client.problems();
  REQUIRE(problems.has_value());
  CHECK(problems->complete);
  REQUIRE(problems->problems.size() == 1);
  CHECK(problems->problems[0].error.place->line == 17);
  CHECK(problems->problems[0].length == 4);
  CHECK(problems->problems[0].calls ==
        std::vector<api::CallSite>{{"pocket", api::TextPlace{"part.nc", 3, 0}}});
}

}  // namespace
}  // namespace cnc::test
