// Continuous jog: the caller, and nobody else, keeps the machine moving.
#include <catch2/catch.hpp>
#include <chrono>

#include "api/client.h"
#include "tests/api/fake_server.h"

namespace cnc::test {
namespace {

using api::Axis;
using api::Client;
using api::ErrorKind;
using namespace std::chrono_literals;

struct Fixture {
  TemporaryFolder folder;
  FakeMachine machine;
  FakeServer server{machine, folder.socket()};
  Client client = Client::without_connecting(server.address());
};

TEST_CASE("A jog whose caller hangs stops when its lease runs out", "[api][safety]") {
  Fixture f;
  api::JogSession session = f.client.jog({.lease = 100ms});
  REQUIRE(session.set({{Axis::X, 0.5}}));
  // The caller does nothing more; the session still lives.
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.leases_run_out == 1; }));
  const std::lock_guard lock(f.machine.mutex);
  CHECK(f.machine.jog_rates.size() == 1);
  CHECK(f.machine.jog_lease == 0.1);
  CHECK_FALSE(f.machine.jogging);
}

TEST_CASE("A held key is renewed every third of the lease, then the machine stops", "[api]") {
  Fixture f;
  api::JogSession session = f.client.jog({.lease = 300ms});
  CHECK(session.renewal_interval() == 100ms);
  int times = 0;
  REQUIRE(session.while_held({{Axis::Y, -0.25}}, [&] { return ++times <= 4; }));
  const std::lock_guard lock(f.machine.mutex);
  CHECK(f.machine.leases_run_out == 0);
  REQUIRE(f.machine.jog_rates.size() == 5);  // four renewals and the stop
  for (std::size_t i = 0; i < 4; ++i) CHECK(f.machine.jog_rates[i].at(v1::AXIS_Y) == -0.25);
  CHECK(f.machine.jog_rates[4] == std::vector<double>(7, 0.0));
  CHECK(f.machine.jog_streams_ended == 1);
}

TEST_CASE("The end of a session stops the machine", "[api][safety]") {
  Fixture f;
  {
    api::JogSession session = f.client.jog({.lease = 1000ms});
    REQUIRE(session.set({{Axis::X, 1.0}}));
    REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.jogging; }));
  }
  CHECK(f.machine.becomes([](FakeMachine& m) { return m.jog_streams_ended == 1 && !m.jogging; }));
}

TEST_CASE("Velocities can change within a session, and none stops the machine", "[api]") {
  Fixture f;
  api::JogSession session = f.client.jog();
  REQUIRE(session.set({{Axis::X, 1.0}}));
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.jog_rates.size() == 1; }));
  REQUIRE(session.set({{Axis::X, -0.5}, {Axis::Z, 0.1}}));
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.jog_rates.size() == 2; }));
  REQUIRE(session.set({}));
  REQUIRE(f.machine.becomes([](FakeMachine& m) { return m.jog_rates.size() == 3; }));
  const std::lock_guard lock(f.machine.mutex);
  CHECK(f.machine.jog_rates[1].at(v1::AXIS_X) == -0.5);
  CHECK(f.machine.jog_rates[1].at(v1::AXIS_Z) == 0.1);
  CHECK_FALSE(f.machine.jogging);
}

TEST_CASE("A refused jog ends the session and says why", "[api]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) {
    m.failures["Jog"] =
        failure(grpc::StatusCode::FAILED_PRECONDITION,
                error_detail(5001, "command_not_allowed", "Home X first.", "Home."));
  });
  api::JogSession session = f.client.jog();
  const auto result = session.while_held({{Axis::X, 1.0}}, [] { return true; });
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().kind == ErrorKind::refused);
  CHECK(result.error().message == "Home X first.");
  const auto again = session.set({{Axis::X, 1.0}});
  REQUIRE_FALSE(again.has_value());
  CHECK(again.error().message == "Home X first.");
  CHECK_FALSE(session.moving());
}

TEST_CASE("A jog without a server is an error, not a wait", "[api]") {
  const TemporaryFolder folder;
  const Client client = Client::without_connecting(folder.socket());
  const auto result = client.jog().while_held({{Axis::X, 1.0}}, [] { return true; });
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().kind == ErrorKind::unavailable);
}

TEST_CASE("A jog whose server answers no more ends with an error", "[api][safety]") {
  Fixture f;
  f.machine.change([](FakeMachine& m) { m.silent = true; });
  api::JogSession session = f.client.jog();
  const auto end = std::chrono::steady_clock::now() + kPatience;
  const auto result =
      session.while_held({{Axis::X, 1.0}}, [&] { return std::chrono::steady_clock::now() < end; });
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().kind == ErrorKind::unavailable);
  CHECK(f.machine.becomes([](FakeMachine& m) { return m.jog_streams_ended == 1; }));
}

TEST_CASE("A finished session has told the server to stop and has heard its last word", "[api]") {
  Fixture f;
  api::JogSession session = f.client.jog();
  REQUIRE(session.set({{Axis::X, 1.0}}));
  REQUIRE(session.finish());
  const std::lock_guard lock(f.machine.mutex);
  CHECK_FALSE(f.machine.jogging);
  CHECK(f.machine.jog_streams_ended == 1);
  CHECK(f.machine.jog_rates.back() == std::vector<double>(7, 0.0));
}

}  // namespace
}  // namespace cnc::test
