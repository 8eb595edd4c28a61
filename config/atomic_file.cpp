#include "config/atomic_file.h"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace cnc::config {
namespace {

constexpr mode_t kNewFileMode = 0644;

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;

  [[nodiscard]] bool valid() const { return fd_ >= 0; }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

// Removes the temporary file on every way out but the one where it has become the real file.
class TemporaryName {
 public:
  explicit TemporaryName(std::string name) : name_(std::move(name)) {}
  ~TemporaryName() {
    if (!released_) ::unlink(name_.c_str());
  }
  TemporaryName(const TemporaryName&) = delete;
  TemporaryName& operator=(const TemporaryName&) = delete;

  [[nodiscard]] const char* c_str() const { return name_.c_str(); }
  void release() { released_ = true; }

 private:
  std::string name_;
  bool released_ = false;
};

std::unexpected<Error> cannot(std::string_view step, const std::filesystem::path& path) {
  const std::string reason = std::generic_category().message(errno);
  return fail(ErrorCode::file_not_writable,
              fmt::format("Cannot {} {}: {}.", step, path.string(), reason));
}

bool write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const auto written = ::write(fd, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// The rename itself is only safe once the directory that holds the name has reached the disk.
Result<void> flush_directory(const std::filesystem::path& directory) {
  const FileDescriptor fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.valid() || ::fsync(fd.get()) != 0) return cannot("flush the directory", directory);
  return {};
}

Result<void> replace_file(const std::filesystem::path& path, std::string_view content,
                          mode_t mode) {
  std::string pattern = path.string() + ".tmp-XXXXXX";
  const FileDescriptor fd(::mkostemp(pattern.data(), O_CLOEXEC));
  if (!fd.valid()) return cannot("create a temporary file beside", path);
  TemporaryName temporary(std::move(pattern));

  if (::fchmod(fd.get(), mode) != 0) return cannot("set the permissions of", path);
  if (!write_all(fd.get(), content)) return cannot("write", path);
  if (::fsync(fd.get()) != 0) return cannot("flush", path);
  if (::rename(temporary.c_str(), path.c_str()) != 0) return cannot("replace", path);
  temporary.release();
  return flush_directory(path.parent_path());
}

struct OldFile {
  std::string content;
  mode_t mode = kNewFileMode;
};

Result<std::optional<OldFile>> read_old_file(const std::filesystem::path& path) {
  const FileDescriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!fd.valid() && errno == ENOENT) return std::nullopt;
  if (!fd.valid()) return cannot("read the old version of", path);
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0) return cannot("read the old version of", path);
  OldFile old{{}, status.st_mode & 07777};
  char buffer[16 * 1024];
  for (;;) {
    const auto count = ::read(fd.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return cannot("read the old version of", path);
    if (count == 0) return old;
    old.content.append(buffer, static_cast<std::size_t>(count));
  }
}

}  // namespace

std::filesystem::path backup_path(const std::filesystem::path& path) {
  return path.string() + ".bak";
}

Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  std::error_code error;
  const auto target = std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
  if (error) {
    return fail(ErrorCode::file_not_writable,
                fmt::format("Cannot find {}: {}.", path.string(), error.message()));
  }
  const auto old = read_old_file(target);
  if (!old) return std::unexpected(old.error());
  if (!*old) return replace_file(target, content, kNewFileMode);
  // A copy, not a hard link: it works on every file system and never leaves the name unoccupied.
  if ((*old)->content != content) {
    const auto kept = replace_file(backup_path(target), (*old)->content, (*old)->mode);
    if (!kept) return kept;
  }
  return replace_file(target, content, (*old)->mode);
}

}  // namespace cnc::config
