// Shows what a program asks while cncctl waits for it, and asks it on the terminal, if there is
// one.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "api/cncctl/context.h"

namespace cnc::ctl {

/// Is fed with statuses, never waits for the terminal, and so notices when somebody else answers.
/// Questions go to stderr, as the prompts of a shell do.
class Asker {
 public:
  Asker(const api::Client& client, bool json) : client_(client), json_(json) {}

  /// Whether see() would print something new.
  [[nodiscard]] bool has_news(const api::MachineStatus& status) const {
    return status.question != known_;
  }
  /// Shows a new question; reads what has been typed; answers when the last value is there.
  void see(const api::MachineStatus& status);
  /// A prompt stands on the terminal: nothing else is to be printed there.
  [[nodiscard]] bool is_asking() const { return is_asking_; }

 private:
  void change(const std::optional<api::Question>& question);
  void prompt() const;
  void read_terminal();
  void take_line(std::string_view line);
  void take_value(std::string_view word);
  void take_decision(std::string_view word);
  void answer(bool confirmed);

  const api::Client& client_;
  const bool json_;
  std::optional<api::Question> known_;
  std::vector<double> values_;  // typed so far
  bool is_asking_ = false;
};

/// Makes a call that may take as long as a program, and shows meanwhile what that asks.
[[nodiscard]] api::Result<void> while_asking(const Context& context,
                                             const std::function<api::Result<void>()>& call);

}  // namespace cnc::ctl
