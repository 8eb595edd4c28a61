// Parameters and tools on disk. Saving happens on a thread of its own: fsync may take long, and the
// executor has motion to feed. Whoever has to know asks for the outcome of the ticket.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "config/parameter_store.h"
#include "config/tool_table.h"
#include "server/machine/message_log.h"

namespace cnc::server {

struct StateFiles {
  std::filesystem::path parameters;  ///< an empty path saves nothing (simulation)
  std::filesystem::path tools;
};

class StateSaver {
 public:
  using Ticket = std::uint64_t;

  /// Errors go to `log`, too.
  StateSaver(StateFiles files, MessageLog& log);
  /// Writes what is still waiting, then ends.
  ~StateSaver();

  /// Takes a copy and returns at once. Of several copies that wait the newest is written; what was
  /// handed over already is not written again.
  Ticket save(const config::ParameterStore& parameters, const config::ToolTable& tools);
  /// How the save of the ticket, or a later one, ended; nothing while it is under way.
  [[nodiscard]] std::optional<Result<void>> outcome(Ticket ticket) const;
  /// Blocks until everything handed over so far has been written or refused.
  void wait();

 private:
  struct Texts {
    std::string parameters;
    std::string tools;

    friend bool operator==(const Texts&, const Texts&) = default;
  };

  void work();
  [[nodiscard]] Result<void> write(const Texts& texts, const Texts& written) const;

  const StateFiles files_;
  MessageLog& log_;
  mutable std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  Texts newest_texts_;  // as handed over
  Texts written_;       // as on disk; empty: not known
  Ticket newest_ = 0;
  Ticket done_ = 0;
  Result<void> result_;  // of done_
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace cnc::server
