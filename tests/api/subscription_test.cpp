// Subscriptions: they live through restarts of the server and tell when it is gone.
#include <catch2/catch.hpp>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <vector>

#include "api/client.h"
#include "tests/api/fake_server.h"

namespace cnc::test {
namespace {

using api::Client;
using api::ConnectionChange;
using api::ErrorKind;
using Clock = std::chrono::steady_clock;

/// What a subscription has told so far.
class Told {
 public:
  void status(const api::MachineStatus& status) {
    const std::lock_guard lock(mutex_);
    statuses_.push_back(status);
    changed_.notify_all();
  }
  void message(const api::Message& message) {
    const std::lock_guard lock(mutex_);
    texts_.push_back(message.text);
    changed_.notify_all();
  }
  void connection(const ConnectionChange& change) {
    const std::lock_guard lock(mutex_);
    changes_.push_back(change);
    changed_.notify_all();
  }

  [[nodiscard]] bool waits_for_statuses(std::size_t count) {
    return wait([&] { return statuses_.size() >= count; });
  }
  [[nodiscard]] bool waits_for_texts(const std::vector<std::string>& texts) {
    return wait([&] { return texts_ == texts; });
  }
  [[nodiscard]] std::optional<ConnectionChange> waits_for_change(std::size_t number) {
    if (!wait([&] { return changes_.size() >= number; })) return std::nullopt;
    const std::lock_guard lock(mutex_);
    return changes_[number - 1];
  }
  [[nodiscard]] std::size_t statuses() {
    const std::lock_guard lock(mutex_);
    return statuses_.size();
  }
  [[nodiscard]] std::size_t changes() {
    const std::lock_guard lock(mutex_);
    return changes_.size();
  }

 private:
  template <typename Condition>
  bool wait(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, condition);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<api::MachineStatus> statuses_;
  std::vector<std::string> texts_;
  std::vector<ConnectionChange> changes_;
};

api::Subscription watch_status(const Client& client, Told& told) {
  return client.subscribe_status(
      {.max_rate = 100.0}, [&](const api::MachineStatus& status) { told.status(status); },
      [&](const ConnectionChange& change) { told.connection(change); });
}

api::Subscription watch_messages(const Client& client, std::uint64_t after, Told& told) {
  return client.subscribe_messages(
      after, [&](const api::Message& message) { told.message(message); },
      [&](const ConnectionChange& change) { told.connection(change); });
}

v1::Message message(std::uint64_t sequence, std::int64_t time, const std::string& text) {
  v1::Message result;
  result.set_sequence(sequence);
  result.set_time_unix_ms(time);
  result.set_text(text);
  return result;
}

TEST_CASE("A status subscription lives through a restart of the server", "[api][ARC-1]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  Told told;
  auto server = std::make_optional<FakeServer>(machine, folder.socket());
  const Client client = Client::without_connecting(folder.socket());
  const auto subscription = watch_status(client, told);
  REQUIRE(told.waits_for_statuses(2));
  REQUIRE(told.waits_for_change(1)->connected);

  const auto gone = Clock::now();
  server.reset();
  const auto lost = told.waits_for_change(2);
  REQUIRE(lost.has_value());
  CHECK_FALSE(lost->connected);
  CHECK(lost->reason->kind == ErrorKind::unavailable);
  CHECK(Clock::now() - gone < std::chrono::seconds(2));

  const std::size_t before = told.statuses();
  server.emplace(machine, folder.socket());
  REQUIRE(told.waits_for_change(3)->connected);
  CHECK(told.waits_for_statuses(before + 2));
}

TEST_CASE("A server that falls silent is reported within two seconds", "[api]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  Told told;
  const FakeServer server(machine, folder.socket());
  const Client client = Client::without_connecting(folder.socket());
  const auto subscription = watch_status(client, told);
  REQUIRE(told.waits_for_statuses(1));
  machine.change([](FakeMachine& m) { m.silent = true; });
  const auto silent = Clock::now();
  const auto lost = told.waits_for_change(2);
  REQUIRE(lost.has_value());
  CHECK_FALSE(lost->connected);
  CHECK(Clock::now() - silent < std::chrono::seconds(2));
}

TEST_CASE("A subscription may be older than its server", "[api]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  Told told;
  const Client client = Client::without_connecting(folder.socket());
  const auto subscription = watch_status(client, told);
  const auto first = told.waits_for_change(1);
  REQUIRE(first.has_value());
  CHECK_FALSE(first->connected);
  const FakeServer server(machine, folder.socket());
  REQUIRE(told.waits_for_change(2)->connected);
  CHECK(told.waits_for_statuses(1));
}

TEST_CASE("A subscription tells of a server of another version and gets nothing from it",
          "[api][ARC-3]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  machine.api_major = 7;
  Told told;
  const FakeServer server(machine, folder.socket());
  const Client client = Client::without_connecting(folder.socket());
  const auto subscription = watch_status(client, told);
  const auto first = told.waits_for_change(1);
  REQUIRE(first.has_value());
  CHECK(first->reason->kind == ErrorKind::incompatible);
  CHECK_FALSE(machine.has_seen("Watch"));
}

TEST_CASE("Attempts that fail for the same reason are told once", "[api]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  machine.failures["GetVersion"] = grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
  Told told;
  const FakeServer server(machine, folder.socket());
  const Client client = Client::without_connecting(folder.socket());
  const auto subscription = watch_status(client, told);
  REQUIRE(machine.becomes([](FakeMachine& m) { return m.calls.size() >= 3; }));
  CHECK(told.changes() == 1);
}

TEST_CASE("After its destruction a subscription calls nobody", "[api]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  const FakeServer server(machine, folder.socket());
  const Client client = Client::without_connecting(folder.socket());
  Told told;
  std::size_t at_end = 0;
  {
    const auto subscription = watch_status(client, told);
    REQUIRE(told.waits_for_statuses(2));
  }
  at_end = told.statuses();
  const std::uint64_t sequence = [&] {
    const std::lock_guard lock(machine.mutex);
    return machine.status.sequence();
  }();
  // Another subscriber sees the time pass in which the first would have been called.
  Told other;
  const auto subscription = watch_status(client, other);
  REQUIRE(machine.becomes([&](FakeMachine& m) { return m.status.sequence() > sequence + 5; }));
  CHECK(told.statuses() == at_end);
}

TEST_CASE("A subscription outlives its client", "[api]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  const FakeServer server(machine, folder.socket());
  Told told;
  const auto subscription = [&] {
    const Client client = Client::without_connecting(folder.socket());
    return watch_status(client, told);
  }();
  CHECK(told.waits_for_statuses(3));
}

TEST_CASE("A slow subscriber gets the newest status, not all", "[api]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  const FakeServer server(machine, folder.socket());
  const Client client = Client::without_connecting(folder.socket());
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::uint64_t> sequences;
  const auto subscription =
      client.subscribe_status({.max_rate = 100.0}, [&](const api::MachineStatus& status) {
        if (status.sequence == 1) {
          // Slow: not before 30 more have been sent.
          (void)machine.becomes([](FakeMachine& m) { return m.status.sequence() >= 31; });
        }
        const std::lock_guard lock(mutex);
        sequences.push_back(status.sequence);
        changed.notify_all();
      });
  std::unique_lock lock(mutex);
  REQUIRE(changed.wait_for(lock, kPatience, [&] { return sequences.size() >= 2; }));
  CHECK(sequences[1] > 20);
}

TEST_CASE("Messages come in order, each once, over a restart that keeps them", "[api]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  machine.messages = {message(1, 1000, "one"), message(2, 2000, "two")};
  Told told;
  auto server = std::make_optional<FakeServer>(machine, folder.socket());
  const Client client = Client::without_connecting(folder.socket());
  const auto subscription = watch_messages(client, 1, told);
  REQUIRE(told.waits_for_texts({"two"}));
  server.reset();
  REQUIRE_FALSE(told.waits_for_change(2)->connected);
  machine.change([](FakeMachine& m) { m.messages.push_back(message(3, 3000, "three")); });
  server.emplace(machine, folder.socket());
  CHECK(told.waits_for_texts({"two", "three"}));
}

TEST_CASE("A server that counts its messages anew is read from the first", "[api]") {
  const TemporaryFolder folder;
  FakeMachine machine;
  machine.messages = {message(1, 1000, "one"), message(2, 2000, "two")};
  Told told;
  auto server = std::make_optional<FakeServer>(machine, folder.socket());
  const Client client = Client::without_connecting(folder.socket());
  const auto subscription = watch_messages(client, 0, told);
  REQUIRE(told.waits_for_texts({"one", "two"}));
  server.reset();
  REQUIRE_FALSE(told.waits_for_change(2)->connected);
  const bool has_fewer = GENERATE(true, false);
  machine.change([&](FakeMachine& m) {
    m.messages = {message(1, 5000, "new one")};
    if (!has_fewer) m.messages.push_back(message(2, 6000, "new two"));
  });
  server.emplace(machine, folder.socket());
  if (has_fewer) {
    CHECK(told.waits_for_texts({"one", "two", "new one"}));
  } else {
    CHECK(told.waits_for_texts({"one", "two", "new one", "new two"}));
  }
}

}  // namespace
}  // namespace cnc::test
