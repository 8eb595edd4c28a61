#include "api/cncctl/run_progress.h"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdio>
#include <fmt/format.h>
#include <mutex>
#include <optional>
#include <ranges>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "api/cncctl/asker.h"
#include "api/cncctl/json.h"
#include "api/cncctl/text.h"

namespace cnc::ctl {
namespace {

using api::MachineState;

constexpr std::array kStatesOfAJob{MachineState::running,     MachineState::pausing,
                                   MachineState::paused,      MachineState::program_stop,
                                   MachineState::tool_change, MachineState::question,
                                   MachineState::stopping};
constexpr std::array kStatesThatWait{MachineState::paused, MachineState::program_stop,
                                     MachineState::tool_change, MachineState::question};

// A job that was seen is over in these. Not in any other: an operator may jog while the program
// waits, and a program may home.
constexpr std::array kStatesBetweenJobs{MachineState::ready, MachineState::needs_homing};

// The program asks for somebody's hand; a pause is somebody's will and is not answered for him.
constexpr std::array kPrompts{MachineState::program_stop, MachineState::tool_change,
                              MachineState::question};

// No job can be started in these.
constexpr std::array kStatesWithoutJob{MachineState::off, MachineState::needs_reset,
                                       MachineState::estop, MachineState::error};

template <typename States>
bool is_one_of(const States& states, MachineState state) {
  return std::ranges::find(states, state) != states.end();
}

/// The newest status, handed from the subscription's thread to the waiting one.
class Mailbox {
 public:
  void put(api::Result<api::MachineStatus> status) {
    const std::lock_guard lock(mutex_);
    newest_ = std::move(status);
    changed_.notify_all();
  }

  /// Nothing if interrupted.
  std::optional<api::Result<api::MachineStatus>> take(const std::stop_token& interrupted) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, interrupted, [this] { return newest_.has_value(); });
    return std::exchange(newest_, std::nullopt);
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<api::Result<api::MachineStatus>> newest_;
};

std::size_t terminal_width() {
  winsize size{};
  constexpr std::size_t kUsual = 80;
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsual;
  return size.ws_col;
}

std::string bar(double progress) {
  constexpr std::size_t kWidth = 20;
  const auto filled = static_cast<std::size_t>(std::clamp(progress, 0.0, 1.0) * kWidth);
  return '[' + std::string(filled, '#') + std::string(kWidth - filled, '.') + ']';
}

/// A bar on a terminal; a line for every tenth of the job and for every wait elsewhere; statuses as
/// JSON if wanted.
class ProgressPrinter {
 public:
  ProgressPrinter(bool enabled, bool json, std::vector<api::Axis> axes)
      : enabled_(enabled),
        json_(json),
        is_terminal_(isatty(STDOUT_FILENO) != 0),
        axes_(std::move(axes)) {}

  void show(const api::MachineStatus& status) {
    const int tenth = static_cast<int>(status.job.progress * 10.0);
    const bool is_news = tenth != last_tenth_ || status.state != last_state_;
    last_tenth_ = tenth;
    last_state_ = status.state;
    if (!enabled_) return;
    if (json_ && is_news) {
      fmt::print("{}\n", to_json(status).dump());
    } else if (!json_ && is_terminal_) {
      fmt::print("\r\x1b[K{}",
                 (bar(status.job.progress) + ' ' + line(status)).substr(0, terminal_width() - 1));
      has_bar_ = true;
    } else if (!json_ && is_news) {
      fmt::print("{}\n", line(status));
    }
    std::fflush(stdout);
  }

  /// Leaves the line of the bar.
  void end() {
    if (std::exchange(has_bar_, false)) fmt::print("\n");
    std::fflush(stdout);
  }

 private:
  [[nodiscard]] std::string line(const api::MachineStatus& status) const {
    const api::JobStatus& job = status.job;
    std::string text =
        fmt::format("{:3.0f} % line {}/{}", 100.0 * job.progress, job.line, job.lines);
    if (job.prediction_ready) text += fmt::format(" {} left", format_duration(job.time_left));
    text += fmt::format(" {} F{:.0f}", format_position(status.work_position, axes_),
                        60.0 * status.feed);
    if (is_one_of(kStatesThatWait, status.state)) text += " - " + status.state_text;
    return text;
  }

  const bool enabled_;
  const bool json_;
  const bool is_terminal_;
  const std::vector<api::Axis> axes_;
  int last_tenth_ = -1;
  MachineState last_state_ = MachineState::unknown;
  bool has_bar_ = false;
};

/// What the machine said last about why it did not go on.
api::Error reason_of_failure(const api::Client& client, std::uint64_t newest_before,
                             const api::MachineStatus& end) {
  const auto messages = client.messages(newest_before);
  if (messages) {
    for (const api::Message& message : *messages | std::views::reverse) {
      if (message.error) return *message.error;
    }
  }
  return {.kind = api::ErrorKind::failed,
          .message =
              fmt::format("The job ended at line {} of {} before its end; the machine is now: {}.",
                          end.job.line, end.job.lines, name_of(end.state)),
          .check = "Messages: cncctl messages."};
}

void print_times(const api::JobStatus& job, bool json) {
  if (json) return;
  fmt::print("job time {}", format_duration(job.elapsed));
  if (job.prediction_ready) fmt::print(", predicted {}", format_duration(job.predicted_time));
  fmt::print("\n");
}

/// Tells from the statuses whether the job has ended. The first of them may be older than the start
/// of the run, so "ready" counts only after the job was seen running.
class EndOfRun {
 public:
  explicit EndOfRun(std::uint64_t runs_before) : runs_before_(runs_before) {}

  [[nodiscard]] bool reached(const api::MachineStatus& now) {
    was_running_ = was_running_ || is_one_of(kStatesOfAJob, now.state);
    return is_counted(now) || (was_running_ && is_one_of(kStatesBetweenJobs, now.state)) ||
           is_one_of(kStatesWithoutJob, now.state);
  }

  [[nodiscard]] bool is_good(const api::MachineStatus& end) const {
    return is_counted(end) && end.job.ended_well;
  }

 private:
  [[nodiscard]] bool is_counted(const api::MachineStatus& now) const {
    return now.job.runs > runs_before_;
  }

  std::uint64_t runs_before_;
  bool was_running_ = false;
};

/// Answers each prompt of the program once, and again every second while it stands: two prompts may
/// follow each other so closely that no status shows the motion between them.
class PromptAnswer {
 public:
  explicit PromptAnswer(const api::Client& client) : client_(client) {}

  [[nodiscard]] api::Result<void> see(const api::MachineStatus& now) {
    if (!is_one_of(kPrompts, now.state)) {
      quiet_until_ = 0.0;
      return {};
    }
    if (now.time < quiet_until_) return {};
    quiet_until_ = now.time + 1.0;
    auto went_on = now.question ? client_.answer(now.question->number, true) : client_.resume();
    // Refused: the status was old, or somebody else has answered.
    if (!went_on && went_on.error().kind != api::ErrorKind::refused) return went_on;
    return {};
  }

 private:
  const api::Client& client_;
  double quiet_until_ = 0.0;  // s of the server's monotonic clock, which is never negative
};

}  // namespace

api::Result<ExitCode> run_and_wait(const Context& context, const RunOptions& options) {
  const api::Client& client = context.client;
  const auto machine = client.machine();
  if (!machine) return std::unexpected(machine.error());
  const auto before = client.status();
  if (!before) return std::unexpected(before.error());
  if (auto started = client.run(); !started) return std::unexpected(started.error());

  std::vector<api::Axis> axes;
  for (const api::AxisDescription& each : machine->axes) axes.push_back(each.axis);
  ProgressPrinter printer(options.show_progress, context.options.json, std::move(axes));

  EndOfRun end(before->job.runs);
  PromptAnswer prompts(client);
  Asker asker(client, context.options.json);
  Mailbox mailbox;
  const auto subscription = client.subscribe_status(
      {.max_rate = 10.0}, [&](const api::MachineStatus& status) { mailbox.put(status); },
      [&](const api::ConnectionChange& change) {
        if (change.reason) mailbox.put(std::unexpected(*change.reason));
      });

  while (const auto status = mailbox.take(context.interrupted)) {
    if (!*status) {
      printer.end();
      return std::unexpected(status->error());
    }
    const api::MachineStatus& now = **status;
    if (options.go_on) {
      if (auto answered = prompts.see(now); !answered) {
        printer.end();
        return std::unexpected(answered.error());
      }
    } else {
      if (asker.has_news(now)) printer.end();
      asker.see(now);
    }
    if (!asker.is_asking()) printer.show(now);
    if (!end.reached(now)) continue;
    printer.end();
    print_times(now.job, context.options.json);
    if (end.is_good(now)) return ExitCode::ok;
    return std::unexpected(reason_of_failure(client, before->newest_message, now));
  }
  printer.end();
  return ExitCode::interrupted;
}

}  // namespace cnc::ctl
