#include "server/daemon/trace_keeper.h"

#include <algorithm>
#include <fmt/format.h>
#include <thread>
#include <utility>
#include <vector>

#include "config/atomic_file.h"
#include "server/link/link_trace.h"

namespace cnc::server {
namespace {

constexpr std::string_view kSuffix = ".trace";
constexpr std::string_view kAskedFor = "asked_for";

/// "estop, link_lost" as a part of a file name: its first word. Colons and the like are no part of
/// a name on a memory stick.
std::string file_name(std::string time, std::string_view reason) {
  std::ranges::replace(time, ':', '-');
  return fmt::format("{}_{}{}", time, reason.substr(0, reason.find_first_of(", ")), kSuffix);
}

}  // namespace

TraceKeeper::TraceKeeper(const hal::trace::Ring& ring, MessageLog& log, hal::trace::About about,
                         TraceKeeperSettings settings)
    : ring_(ring), log_(log), about_(std::move(about)), settings_(std::move(settings)) {}

void TraceKeeper::save_after_fault(std::string_view reason) {
  if (fault_pending_.exchange(true)) return;
  thread_.post([this, reason = std::string(reason)] {
    std::this_thread::sleep_for(settings_.aftermath);
    fault_pending_ = false;
    write_after_fault(reason);
  });
}

void TraceKeeper::save_now(Answer answer) {
  thread_.post([this, answer = std::move(answer)] { answer(write_when_asked()); });
}

Result<std::filesystem::path> TraceKeeper::write_when_asked() {
  const Moment now = std::chrono::steady_clock::now();
  if (last_asked_ && now - last_asked_->when < settings_.rest && exists(last_asked_->path))
    return last_asked_->path;
  auto written = write(std::string(kAskedFor));
  if (written) last_asked_ = {now, *written};
  return written;
}

void TraceKeeper::write_after_fault(const std::string& reason) {
  const auto now = std::chrono::steady_clock::now();
  if (last_fault_ && now - *last_fault_ < settings_.pause) return;
  last_fault_ = now;
  last_asked_.reset();  // it does not have the fault
  const auto written = write(reason);
  if (written) {
    warned_ = false;
    log_.add(Severity::info, fmt::format("The last 30 s of the link before this fault are in {}.",
                                         written->string()));
  } else if (!std::exchange(warned_, true)) {
    log_.add(Severity::warning, "No trace of the link was kept. " + written.error().message);
  }
}

Result<std::filesystem::path> TraceKeeper::write(const std::string& reason) {
  std::error_code error;
  std::filesystem::create_directories(settings_.folder, error);
  if (error)
    return fail(ErrorCode::file_not_writable,
                fmt::format("Cannot create the folder {}: {}.", settings_.folder.string(),
                            error.message()));
  about_.reason = reason;
  about_.written = utc_text(std::chrono::system_clock::now());
  const auto path = settings_.folder / file_name(about_.written, reason);
  try {
    const std::string bytes = hal::trace::trace_bytes(about_, ring_.copy());
    if (auto written = config::write_file_atomically(path, bytes); !written)
      return std::unexpected(written.error());
  } catch (const std::bad_alloc&) {  // locked memory may be scarce
    return fail(ErrorCode::file_not_writable, "There is not enough memory for a trace.");
  }
  remove_oldest();
  return path;
}

/// Their names begin with the time. What is not a trace is left alone; traces that were asked for
/// do not push out those of faults.
void TraceKeeper::remove_oldest() const {
  std::vector<std::filesystem::path> asked_for;
  std::vector<std::filesystem::path> of_faults;
  std::error_code error;
  std::filesystem::directory_iterator entry(settings_.folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (entry->path().extension() != kSuffix) continue;
    (entry->path().stem().string().ends_with(kAskedFor) ? asked_for : of_faults)
        .push_back(entry->path());
  }
  for (auto* traces : {&asked_for, &of_faults}) {
    std::ranges::sort(*traces);
    for (std::size_t i = 0; i + settings_.kept < traces->size(); ++i)
      std::filesystem::remove((*traces)[i], error);
  }
}

}  // namespace cnc::server
