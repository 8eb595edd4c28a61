#include "tests/end_to_end/test_server.h"

#include <catch2/catch.hpp>

namespace cnc::test {

std::vector<std::string> small_machine() {
  std::vector<std::string> arguments;
  for (const char* setting : {"AXIS_X.positiveLimit=80", "AXIS_Y.positiveLimit=80",
                              "AXIS_Z.negativeLimit=-20", "SPINDLE_0.spindleRampUpTime=0.2"}) {
    arguments.emplace_back("--set");
    arguments.emplace_back(setting);
  }
  return arguments;
}

std::string ServerFolder::write_job(std::string_view text) const {
  config::test::put(file("job.nc"), text);
  return file("job.nc");
}

Process ServerFolder::start(const std::vector<std::string>& more) const {
  std::vector<std::string> arguments{CNCSERVER,     "--data", data(),
                                     "--socket",    socket(), "--listen",
                                     "127.0.0.1:0", "--jobs", directory_.path().string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return {arguments, file("server")};
}

Watcher::Watcher(const api::Client& client)
    : subscription_(client.subscribe_status(
          {.max_rate = 100.0}, [this](const api::MachineStatus& status) { take(status); })) {}

void Watcher::take(const api::MachineStatus& status) {
  {
    const std::scoped_lock lock(mutex_);
    newest_ = status;
    ++count_;
    if (states_.empty() || states_.back() != status.state) states_.push_back(status.state);
  }
  changed_.notify_all();
}

bool Watcher::sees(const std::function<bool(const api::MachineStatus&)>& condition,
                   std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience, [&] { return count_ > 0 && condition(newest_); });
}

bool Watcher::sees(api::MachineState state, std::chrono::milliseconds patience) {
  return sees([state](const api::MachineStatus& status) { return status.state == state; },
              patience);
}

api::MachineStatus Watcher::newest() const {
  const std::scoped_lock lock(mutex_);
  return newest_;
}

std::vector<api::MachineState> Watcher::states() const {
  const std::scoped_lock lock(mutex_);
  return states_;
}

RunningServer::RunningServer(const ServerFolder& server_folder,
                             const std::vector<std::string>& more)
    : folder(server_folder),
      process(server_folder.start(more)),
      client(api::Client::without_connecting(server_folder.address())),
      watcher(client) {
  const bool answers = watcher.sees(api::MachineState::needs_reset);
  INFO(process.out() << process.err());
  REQUIRE(answers);
}

void RunningServer::make_ready() const {
  REQUIRE(client.reset());
  const auto homed = client.home();
  INFO((homed ? "" : homed.error().to_string()));
  REQUIRE(homed);
}

void RunningServer::start_job(std::string_view text) const {
  REQUIRE(client.load(folder.write_job(text)));
  REQUIRE(client.run());
}

}  // namespace cnc::test
