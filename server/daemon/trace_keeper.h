// Writes what the link has recorded to files, on a thread of its own: by itself when the board has
// stopped in a fault, and when somebody asks. The newest ten of either kind stay, the others are
// removed. A file that cannot be written is one warning, and nothing else.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "hal/trace/ring.h"
#include "hal/trace/trace_file.h"
#include "server/daemon/task_thread.h"
#include "server/machine/message_log.h"

namespace cnc::server {

struct TraceKeeperSettings {
  std::filesystem::path folder;              ///< made when the first trace is written
  std::chrono::milliseconds aftermath{500};  ///< recorded behind a fault
  /// A fault that follows a trace so soon gets none: a contact that flickers must not push the
  /// first fault out of the folder.
  std::chrono::milliseconds pause{5000};
  /// Who asks so soon after a file that was asked for gets that one: no client can keep the disk
  /// busy.
  std::chrono::milliseconds rest{1000};
  std::size_t kept = 10;
};

class TraceKeeper {
 public:
  using Answer = std::function<void(const Result<std::filesystem::path>&)>;

  /// `ring` and `log` outlive it.
  TraceKeeper(const hal::trace::Ring& ring, MessageLog& log, hal::trace::About about,
              TraceKeeperSettings settings);

  /// Any thread; the log says where the file is. Faults until it is written are in the same file.
  void save_after_fault(std::string_view reason);
  /// Any thread; answered on the keeper's, with the file that was written for somebody a moment ago
  /// if there is one.
  void save_now(Answer answer);

 private:
  using Moment = std::chrono::steady_clock::time_point;
  struct AskedFor {
    Moment when;
    std::filesystem::path path;
  };

  void write_after_fault(const std::string& reason);
  Result<std::filesystem::path> write_when_asked();
  Result<std::filesystem::path> write(const std::string& reason);
  void remove_oldest() const;

  const hal::trace::Ring& ring_;
  MessageLog& log_;
  hal::trace::About about_;
  const TraceKeeperSettings settings_;
  std::atomic<bool> fault_pending_{false};
  bool warned_ = false;               // the thread's, as below
  std::optional<Moment> last_fault_;  // that got a file
  std::optional<AskedFor> last_asked_;
  TaskThread thread_;  // the last: its tasks use the others
};

}  // namespace cnc::server
