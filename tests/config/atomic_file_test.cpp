#include "config/atomic_file.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/config/temporary_directory.h"

using namespace cnc;
using namespace cnc::config;
using test::content_of;
using test::put;

namespace {

std::size_t count_files(const std::filesystem::path& directory) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(directory), {}));
}

// A disk that is full, as far as this process can tell: no file may grow beyond `bytes`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

}  // namespace

TEST_CASE("A new file is written without a backup or a leftover", "[CFG-1][STA-9]") {
  const test::TemporaryDirectory directory;
  REQUIRE(write_file_atomically(directory.file("a"), "one"));
  CHECK(content_of(directory.file("a")) == "one");
  CHECK(count_files(directory.path()) == 1);
}

TEST_CASE("The version before stays as the backup", "[CFG-1][STA-9]") {
  const test::TemporaryDirectory directory;
  const auto path = directory.file("a");
  REQUIRE(write_file_atomically(path, "one"));
  REQUIRE(write_file_atomically(path, "two"));
  REQUIRE(write_file_atomically(path, "three"));
  CHECK(content_of(path) == "three");
  CHECK(content_of(backup_path(path)) == "two");
  CHECK(count_files(directory.path()) == 2);
}

TEST_CASE("Saving the same content twice keeps the version that differs", "[CFG-1][STA-9]") {
  const test::TemporaryDirectory directory;
  const auto path = directory.file("a");
  for (const char* content : {"one", "two", "two"}) REQUIRE(write_file_atomically(path, content));
  CHECK(content_of(backup_path(path)) == "one");
}

TEST_CASE("A full disk leaves the old file and no leftover", "[CFG-1][STA-9]") {
  const test::TemporaryDirectory directory;
  const auto path = directory.file("a");
  REQUIRE(write_file_atomically(path, "the good old version"));
  {
    const FileSizeLimit limit(100);
    const auto refused = write_file_atomically(path, std::string(1000, 'x'));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::file_not_writable);
    CHECK(refused.error().message.find(path.string()) != std::string::npos);
  }
  CHECK(content_of(path) == "the good old version");
  // The backup is a whole copy of the old version; nothing else is there.
  CHECK(content_of(backup_path(path)) == "the good old version");
  CHECK(count_files(directory.path()) == 2);
}

TEST_CASE("A directory that cannot be written is an error that names the path", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  put(directory.file("plain"), "x");
  for (const auto& path : {directory.file("missing") / "a", directory.file("plain") / "a",
                           std::filesystem::path("/proc/cnc-cannot-be-created")}) {
    INFO(path);
    const auto refused = write_file_atomically(path, "content");
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::file_not_writable);
    CHECK(refused.error().message.find(path.filename().string()) != std::string::npos);
  }
  CHECK(count_files(directory.path()) == 1);
}

TEST_CASE("A directory without write permission keeps the old file", "[CFG-1]") {
  if (::geteuid() == 0) {
    WARN("permissions do not bind root: not tested");
    return;
  }
  const test::TemporaryDirectory directory;
  put(directory.file("a"), "old");
  ::chmod(directory.path().c_str(), 0500);
  const auto refused = write_file_atomically(directory.file("a"), "new");
  ::chmod(directory.path().c_str(), 0700);
  REQUIRE_FALSE(refused);
  CHECK(content_of(directory.file("a")) == "old");
}

TEST_CASE("Permissions are kept and a symbolic link stays a link", "[CFG-1]") {
  const test::TemporaryDirectory directory;
  const auto target = directory.file("target");
  const auto link = directory.file("link");
  put(target, "old");
  ::chmod(target.c_str(), 0640);
  std::filesystem::create_symlink(target, link);
  REQUIRE(write_file_atomically(link, "new"));
  CHECK(std::filesystem::is_symlink(link));
  CHECK(content_of(target) == "new");
  struct stat status {};
  REQUIRE(::stat(target.c_str(), &status) == 0);
  CHECK((status.st_mode & 07777) == 0640);
}
