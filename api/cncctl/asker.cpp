#include "api/cncctl/asker.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "api/cncctl/json.h"
#include "api/cncctl/question.h"
#include "api/cncctl/report.h"
#include "api/cncctl/words.h"

namespace cnc::ctl {
namespace {

constexpr std::array<std::string_view, 3> kWordsForOk{"ok", "yes", "y"};
constexpr std::array<std::string_view, 3> kWordsForCancel{"cancel", "no", "n"};

template <typename Words>
bool is_one_of(const Words& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

/// A terminal that is ours to read: in the background it belongs to the shell, and reading it would
/// stop this process.
bool terminal_is_ours() {
  if (isatty(STDIN_FILENO) == 0) return false;
  const pid_t foreground = tcgetpgrp(STDIN_FILENO);
  return foreground < 0 || foreground == getpgrp();
}

bool input_waits() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  return poll(&input, 1, 0) == 1;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

void show_question(const api::Question& question, bool json) {
  if (json) {
    fmt::print("{}\n", nlohmann::json{{"question", to_json(question)}}.dump());
    std::fflush(stdout);
  } else {
    fmt::print(stderr, "The program asks: {}", format_question(question));
  }
}

}  // namespace

void Asker::see(const api::MachineStatus& status) {
  if (has_news(status)) change(status.question);
  if (is_asking_ && terminal_is_ours()) read_terminal();
}

void Asker::change(const std::optional<api::Question>& question) {
  if (is_asking_) {
    fmt::print(stderr, "\n");
    note("the question has been answered elsewhere, or its program was stopped");
  }
  known_ = question;
  values_.clear();
  is_asking_ = false;
  if (!question) return;
  show_question(*question, json_);
  if (json_) return;
  is_asking_ = terminal_is_ours();
  if (!is_asking_) return note("answer it with: " + how_to_answer(*question));
  // An Enter from before the question was there is no answer to it.
  tcflush(STDIN_FILENO, TCIFLUSH);
  if (!question->fields.empty()) note("Enter keeps a value, \"cancel\" cancels");
  prompt();
}

void Asker::prompt() const {
  if (values_.size() < known_->fields.size()) {
    const api::Question::Field& field = known_->fields[values_.size()];
    fmt::print(stderr, "{} [{}]: ", field.label, format_field_value(field.value));
  } else {
    fmt::print(stderr, "ok or cancel? ");
  }
}

void Asker::read_terminal() {
  while (is_asking_ && input_waits()) {
    std::array<char, 1024> line{};  // a terminal hands out one line at a time
    const ssize_t length = read(STDIN_FILENO, line.data(), line.size());
    if (length > 0) {
      take_line({line.data(), static_cast<std::size_t>(length)});
    } else {
      is_asking_ = false;
      fmt::print(stderr, "\n");
      note("not answered here; answer it with: " + how_to_answer(*known_));
    }
  }
}

void Asker::take_line(std::string_view line) {
  const std::string_view word = trimmed(line);
  if (known_->fields.empty()) return take_decision(word);
  if (word == "cancel") return answer(false);
  take_value(word);
}

void Asker::take_value(std::string_view word) {
  try {
    values_.push_back(word.empty() ? known_->fields[values_.size()].value : parse_number(word));
  } catch (const CLI::ValidationError& error) {
    note(error.what());
  }
  if (values_.size() == known_->fields.size()) return answer(true);
  prompt();
}

void Asker::take_decision(std::string_view word) {
  if (is_one_of(kWordsForOk, word)) return answer(true);
  if (is_one_of(kWordsForCancel, word)) return answer(false);
  prompt();
}

void Asker::answer(bool confirmed) {
  is_asking_ = false;
  const auto answered =
      client_.answer(known_->number, confirmed, confirmed ? values_ : std::vector<double>{});
  if (answered) return;
  report(answered.error(), json_);
  known_.reset();  // asked anew if it still stands
}

api::Result<void> while_asking(const Context& context,
                               const std::function<api::Result<void>()>& call) {
  Asker asker(context.client, context.options.json);
  const auto subscription = context.client.subscribe_status(
      {.max_rate = 10.0}, [&](const api::MachineStatus& status) { asker.see(status); });
  return call();
}

}  // namespace cnc::ctl
