// Parameters and tools on disk. Saving happens on a thread of its own: fsync may take long, and the
// executor has motion to feed.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "config/parameter_store.h"
#include "server/machine/message_log.h"

namespace cnc::server {

class ParameterSaver {
 public:
  /// Errors go to `log`. An empty path saves nothing (simulation).
  ParameterSaver(std::filesystem::path path, MessageLog& log);
  /// Writes what is still waiting, then ends.
  ~ParameterSaver();

  /// Takes a copy and returns at once; of several copies that wait, the newest is written.
  void save(const config::ParameterStore& parameters);
  /// Blocks until everything handed over so far is on disk.
  void wait();

 private:
  void work();

  const std::filesystem::path path_;
  MessageLog& log_;
  std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  std::optional<config::ParameterStore> waiting_;
  bool writing_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace cnc::server
