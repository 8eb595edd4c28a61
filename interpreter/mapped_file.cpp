#include "interpreter/mapped_file.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <mutex>
#include <sys/mman.h>
#include <unistd.h>

namespace cnc::interp {
namespace {

/// What the handler knows of a mapped file: addresses, 0 while the row is free.
struct Range {
  std::atomic<std::uintptr_t> begin = 0;
  std::atomic<std::uintptr_t> end = 0;
};

// A signal handler has no other way to know anything than global variables. It takes no lock: `end`
// is set before `begin` and says nothing without it.
constexpr std::size_t kMaxFiles = 64;
constinit std::array<Range, kMaxFiles> ranges;
constinit std::mutex changing_ranges;  ///< not for the handler
struct sigaction handler_before;
std::uintptr_t page_size = 0;

/// Zeros from the page of `address` to `end`. True when that has been possible.
[[nodiscard]] bool replace_by_zeros(std::uintptr_t address, std::uintptr_t end) {
  const std::uintptr_t page = address - address % page_size;
  constexpr int kZeros = MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED | MAP_NORESERVE;
  void* const place = reinterpret_cast<void*>(page);
  return ::mmap(place, end - page, PROT_READ, kZeros, -1, 0) == place;
}

void on_bus_error(int signal, siginfo_t* info, void* /*context*/) {
  const int error_before = errno;
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  for (const Range& range : ranges) {
    const std::uintptr_t begin = range.begin.load();
    const std::uintptr_t end = range.end.load();
    if (begin == 0 || address < begin || address >= end) continue;
    if (range.begin.load() != begin) continue;  // another file's end
    if (!replace_by_zeros(address, end)) break;
    errno = error_before;
    return;
  }
  // Not ours: what raised it will raise it again, for who handled it before.
  ::sigaction(signal, &handler_before, nullptr);
}

void handle_bus_errors() {
  static std::once_flag once;
  std::call_once(once, [] {
    page_size = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    struct sigaction action {};
    action.sa_sigaction = on_bus_error;
    action.sa_flags = SA_SIGINFO;
    ::sigaction(SIGBUS, &action, &handler_before);
  });
}

[[nodiscard]] bool enter(std::uintptr_t begin, std::uintptr_t end) {
  const std::scoped_lock lock(changing_ranges);
  for (Range& range : ranges) {
    if (range.begin.load() != 0) continue;
    range.end.store(end);
    range.begin.store(begin);
    return true;
  }
  return false;
}

void leave(std::uintptr_t begin) {
  const std::scoped_lock lock(changing_ranges);
  for (Range& range : ranges) {
    if (range.begin.load() == begin) range.begin.store(0);
  }
}

}  // namespace

std::unique_ptr<const MappedFile> MappedFile::map(int descriptor, std::size_t size) {
  handle_bus_errors();
  void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (memory == MAP_FAILED) return nullptr;
  const auto begin = reinterpret_cast<std::uintptr_t>(memory);
  if (!enter(begin, begin + size)) {
    ::munmap(memory, size);
    errno = EMFILE;
    return nullptr;
  }
  return std::unique_ptr<const MappedFile>(new MappedFile(static_cast<char*>(memory), size));
}

MappedFile::~MappedFile() {
  leave(reinterpret_cast<std::uintptr_t>(begin_));
  ::munmap(begin_, size_);
}

}  // namespace cnc::interp
