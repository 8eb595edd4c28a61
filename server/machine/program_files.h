// Files that programs write: logfile and logmsg, sp, zhcs (manual 4.2.4).
//
// They live in one folder and nowhere else: a program cannot reach any other file. Writing happens
// on a thread of its own, in the order in which it was asked for; what goes wrong is told in the
// message log. Executor thread only.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "config/axis.h"
#include "config/error.h"
#include "server/machine/message_log.h"

namespace cnc::server {

class ProgramFiles {
 public:
  /// `folder` is made when the first file is; empty: nothing is written (simulation).
  ProgramFiles(std::filesystem::path folder, MessageLog& log);
  /// Writes what is still waiting, then ends.
  ~ProgramFiles();

  /// Where add_line() writes from now on. A name that leads out of the folder is told in the log,
  /// and nothing is written then.
  void open(std::string_view name, bool append);
  void add_line(std::string_view text);
  /// "x y z a b c" on a line of its own.
  void add_position(std::string_view name, bool append, const Position& position);
  Result<void> write(std::string_view name, std::string text);
  /// Blocks until everything handed over so far is on disk.
  void wait();

 private:
  struct Item {
    std::filesystem::path path;
    std::string text;
    bool append = false;
  };

  [[nodiscard]] Result<std::filesystem::path> path_of(std::string_view name) const;
  void push(Item item);
  void work();
  void write_out(const Item& item);

  const std::filesystem::path folder_;
  MessageLog& log_;
  std::filesystem::path log_path_;  // of logmsg; empty: none
  std::mutex mutex_;                // protects the members below
  std::condition_variable changed_;
  std::deque<Item> items_;
  bool busy_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace cnc::server
