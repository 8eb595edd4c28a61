// A connection to a machine: everything a screen, a pendant or a script can ask for.
//
//   auto client = cnc::api::Client::connect();
//   if (!client) { std::cerr << client.error().to_string() << '\n'; return 1; }
//   if (auto done = client->home(); !done) …
//
// Every function may be called from any thread, several at once. Every function answers within its
// deadline, whatever the server does. A refusal leaves the machine as it was; its Error names what
// was wrong and what would be right. No exception leaves this library except std::bad_alloc.
//
// Units: mm, degrees, s, mm/s, rpm; factors where 1 is 100 %. Paths are the server's computer's.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "api/axis.h"
#include "api/error.h"
#include "api/job.h"
#include "api/jog.h"
#include "api/machine.h"
#include "api/message.h"
#include "api/status.h"
#include "api/subscription.h"

namespace cnc::api {

/// Where a server is looked for when nobody says: the environment variable CNC_SERVER if it is set
/// and not empty; else the unix socket cncserver.sock in $XDG_RUNTIME_DIR if that folder exists;
/// else /tmp/cncserver-<uid>.sock. The server listens by the same rule.
[[nodiscard]] std::string default_address();

struct ClientOptions {
  std::chrono::milliseconds connect_timeout{3'000};  ///< for connect()
  std::chrono::milliseconds call_timeout{10'000};    ///< for every call but the next three
  /// For home(), mdi() and run_sub(): the machine stops.
  std::chrono::milliseconds motion_timeout{3'600'000};
};

/// Factors; what is not given stays.
struct OverrideChange {
  std::optional<double> feed{};   ///< 0 … 3
  std::optional<double> rapid{};  ///< 0 … 1
  std::optional<double> speed{};  ///< 0 … 3
};
struct Overrides {
  double feed = 1.0;
  double rapid = 1.0;
  double speed = 1.0;
};

/// The work coordinate that the present position of an axis shall have.
struct WorkCoordinate {
  Axis axis = Axis::X;
  double value = 0.0;
};

class Client {
 public:
  class Impl;

  /// Connects and compares versions. `address` is "unix:///run/user/1000/cncserver.sock" (or
  /// "unix:relative.sock") or "host:port". Errors: unavailable at once when nobody listens,
  /// timed_out, incompatible (names both versions).
  [[nodiscard]] static Result<Client> connect(const std::string& address = default_address(),
                                              const ClientOptions& options = {});
  /// A client for a server that may not run yet: asks nothing. Calls fail as unavailable until the
  /// server is there; a subscription tells when that is, and checks the version.
  [[nodiscard]] static Client without_connecting(const std::string& address = default_address(),
                                                 const ClientOptions& options = {});

  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

  [[nodiscard]] const std::string& address() const;
  /// The server runs on this computer: a unix socket, so paths of files mean the same on both
  /// sides.
  [[nodiscard]] bool is_local() const;

  // Who answers.
  [[nodiscard]] Result<ServerVersion> version() const;
  [[nodiscard]] Result<Machine> machine() const;
  /// `reset`: start counting anew after this answer.
  [[nodiscard]] Result<LinkStatistics> link_statistics(bool reset = false) const;
  /// Writes the last 30 s of the link to a file for `cncsim replay`; its path, on the server's
  /// computer.
  [[nodiscard]] Result<std::string> save_link_trace() const;

  // The state.
  [[nodiscard]] Result<MachineStatus> status() const;
  /// The newest status at once and then at the given rate; a slow reader misses statuses in between
  /// and always gets the newest. A lost server is reported within 2 s, even if it merely falls
  /// silent.
  [[nodiscard]] Subscription subscribe_status(const StatusOptions& options, OnStatus on_status,
                                              OnConnectionChange on_connection_change = {}) const;

  // Commands to the machine.
  /// Switches the drives on, acknowledges estop and errors, ends a running program.
  [[nodiscard]] Result<void> reset() const;
  /// Homes the axes one after the other (none given: all, Z first); answers when the last is homed.
  /// `stop` cancels: the machine stops and the remaining axes are not homed.
  [[nodiscard]] Result<void> home(const std::vector<Axis>& axes = {},
                                  std::stop_token stop = {}) const;
  /// Executes one line of G-code and answers when it has been executed. `stop` cancels: the machine
  /// stops.
  [[nodiscard]] Result<void> mdi(std::string_view line, std::stop_token stop = {}) const;
  /// Runs a sub of the machine's macro files ("user_1", "zero_z") and answers when it has ended,
  /// the questions that it asks included. `stop` cancels: the machine stops.
  [[nodiscard]] Result<void> run_sub(std::string_view name, std::stop_token stop = {}) const;
  /// Acts within one look-ahead. Answers the values that hold now.
  [[nodiscard]] Result<Overrides> set_overrides(const OverrideChange& change) const;
  [[nodiscard]] Result<void> set_work_zero(const std::vector<WorkCoordinate>& coordinates) const;
  /// The operator has checked where these axes stand: their positions are trusted again (none
  /// given: all that are not trusted). Refused if one of them has never been homed.
  [[nodiscard]] Result<void> accept_position(const std::vector<Axis>& axes = {}) const;
  /// Presses or releases the estop button of the virtual board; unsupported on a real one.
  [[nodiscard]] Result<void> simulate_estop(bool pressed) const;

  // Manual motion.
  /// Opens a session for continuous motion, see jog.h; nothing moves before its first set().
  [[nodiscard]] JogSession jog(const JogOptions& options = {}) const;
  /// One step of `distance` (mm or degrees, signed) at `rate` (0 … 1 of the maximum velocity; 0 =
  /// the server's choice, 0.5); steps given while moving add up, up to the soft limit. Answers when
  /// it has been accepted, not when it has been executed.
  [[nodiscard]] Result<void> jog_step(Axis axis, double distance, double rate = 0.0) const;
  /// Stops every jog, whoever started it.
  [[nodiscard]] Result<void> jog_stop() const;

  // The job.
  /// Opens a file of the server's computer and begins its check and time prediction in the
  /// background. The job before stays loaded if this fails.
  [[nodiscard]] Result<LoadedJob> load(std::string_view path) const;
  /// Starts at the first line; answers when it has started.
  [[nodiscard]] Result<void> run() const;
  /// Slows down along the path; answers when the machine stands.
  [[nodiscard]] Result<void> pause() const;
  /// Goes on after a pause, M0, M1 or a tool change.
  [[nodiscard]] Result<void> resume() const;
  /// Slows down along the path and ends the job or the single line; answers when the machine
  /// stands.
  [[nodiscard]] Result<void> stop() const;
  /// Back to the first line.
  [[nodiscard]] Result<void> rewind() const;
  /// Answers MachineStatus::question by its number: OK (`confirmed`) or Cancel. `values`: one for
  /// each field in their order, or none to leave them; Cancel changes none. Refused if that
  /// question is not asked any more: the first answer counts.
  [[nodiscard]] Result<void> answer(std::uint64_t number, bool confirmed,
                                    const std::vector<double>& values = {}) const;
  /// `count` lines (1 … 1000) from line `first` (from 1).
  [[nodiscard]] Result<ProgramText> read_lines(std::uint64_t first, std::uint32_t count) const;
  /// What the check of the loaded file has found so far.
  [[nodiscard]] Result<ProblemList> problems() const;

  // Messages.
  /// Messages after sequence number `after` (0 = from the oldest kept), oldest first; the newest
  /// `limit` of them (0 = all).
  [[nodiscard]] Result<std::vector<Message>> messages(std::uint64_t after = 0,
                                                      std::uint32_t limit = 0) const;
  /// Messages after `after`, then each new one. None is lost or repeated over a reconnection, as
  /// far as the server still has them; after a restart of the server its messages come from the
  /// first.
  [[nodiscard]] Subscription subscribe_messages(std::uint64_t after, OnMessage on_message,
                                                OnConnectionChange on_connection_change = {}) const;

 private:
  explicit Client(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace cnc::api
