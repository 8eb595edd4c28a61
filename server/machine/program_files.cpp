#include "server/machine/program_files.h"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <utility>

namespace cnc::server {

ProgramFiles::ProgramFiles(std::filesystem::path folder, MessageLog& log)
    : folder_(std::move(folder)), log_(log), thread_([this] { work(); }) {}

ProgramFiles::~ProgramFiles() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

Result<std::filesystem::path> ProgramFiles::path_of(std::string_view name) const {
  const std::filesystem::path wanted(name);
  const bool leaves = wanted.is_absolute() || wanted.empty() ||
                      name.find('\\') != std::string_view::npos ||
                      *wanted.lexically_normal().begin() == "..";
  if (!leaves) return folder_ / wanted.lexically_normal();
  return fail(ErrorCode::file_not_writable,
              fmt::format("A program cannot write to \"{}\": only to names within {}.", name,
                          folder_.string()));
}

void ProgramFiles::open(std::string_view name, bool append) {
  log_path_.clear();
  const auto path = path_of(name);
  if (!path) return log_.add(path.error());
  log_path_ = *path;
  if (!append) push({log_path_, {}, false});
}

void ProgramFiles::add_line(std::string_view text) {
  if (!log_path_.empty()) push({log_path_, fmt::format("{}\n", text), true});
}

void ProgramFiles::add_position(std::string_view name, bool append, const Position& position) {
  const auto path = path_of(name);
  if (!path) return log_.add(path.error());
  std::string line;
  for (const Axis axis : kAllAxes)
    line += fmt::format("{}{:.6f}", line.empty() ? "" : " ", position[axis]);
  push({*path, line + "\n", append});
}

Result<void> ProgramFiles::write(std::string_view name, std::string text) {
  const auto path = path_of(name);
  if (!path) return std::unexpected(path.error());
  push({*path, std::move(text), false});
  return {};
}

void ProgramFiles::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return items_.empty() && !busy_; });
}

void ProgramFiles::push(Item item) {
  if (folder_.empty()) return;
  const std::scoped_lock lock(mutex_);
  items_.push_back(std::move(item));
  changed_.notify_all();
}

void ProgramFiles::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return !items_.empty() || ending_; });
    if (items_.empty()) return;
    const Item item = std::move(items_.front());
    items_.pop_front();
    busy_ = true;
    lock.unlock();
    write_out(item);
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
}

void ProgramFiles::write_out(const Item& item) {
  std::error_code ignored;
  std::filesystem::create_directories(item.path.parent_path(), ignored);
  std::ofstream file(item.path, item.append ? std::ios::app : std::ios::trunc);
  file << item.text;
  file.close();
  if (file) return;
  log_.add(Error{ErrorCode::file_not_writable,
                 fmt::format("Cannot write {}: {}.", item.path.string(), std::strerror(errno)),
                 std::nullopt});
}

}  // namespace cnc::server
