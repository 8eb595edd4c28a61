// A cncserver of its own for a test, and somebody who watches what it shows.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>

#include "api/client.h"
#include "tests/config/temporary_directory.h"
#include "tests/patience.h"
#include "tests/process.h"

namespace cnc::test {

/// A small machine that homes and moves in seconds: 80 x 80 x 30 mm. Homed by switch.
[[nodiscard]] std::vector<std::string> small_machine();

/// The folder of a server: data, socket and jobs. Survives the server that uses it.
class ServerFolder {
 public:
  [[nodiscard]] std::string data() const { return directory_.file("data").string(); }
  [[nodiscard]] std::string socket() const { return directory_.file("socket").string(); }
  [[nodiscard]] std::string address() const { return "unix://" + socket(); }
  [[nodiscard]] std::string file(std::string_view name) const {
    return directory_.file(name).string();
  }
  /// Writes a program; its path.
  std::string write_job(std::string_view text) const;

  /// Starts a server; does not wait for it.
  [[nodiscard]] Process start(const std::vector<std::string>& more = small_machine()) const;

 private:
  config::test::TemporaryDirectory directory_;
};

/// Follows a server's status from its own connection.
class Watcher {
 public:
  explicit Watcher(const api::Client& client);

  /// Waits until a status fulfils the condition, beginning with the newest one.
  bool sees(const std::function<bool(const api::MachineStatus&)>& condition,
            std::chrono::milliseconds patience = kPatience);
  bool sees(api::MachineState state, std::chrono::milliseconds patience = kPatience);
  [[nodiscard]] api::MachineStatus newest() const;
  /// All states so far, each change once.
  [[nodiscard]] std::vector<api::MachineState> states() const;

 private:
  void take(const api::MachineStatus& status);

  mutable std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  api::MachineStatus newest_;
  std::uint64_t count_ = 0;
  std::vector<api::MachineState> states_;
  api::Subscription subscription_;
};

/// A server that runs and is watched.
struct RunningServer {
  explicit RunningServer(const ServerFolder& server_folder,
                         const std::vector<std::string>& more = small_machine());

  const ServerFolder& folder;
  Process process;
  api::Client client;
  Watcher watcher;

  /// Drives on and homed.
  void make_ready() const;
  /// Writes, loads and starts a program.
  void start_job(std::string_view text) const;
};

}  // namespace cnc::test
