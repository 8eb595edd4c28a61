// cncctl answer: the answer to what the running program asks.
#include <memory>
#include <string>
#include <vector>

#include "api/cncctl/command_line.h"
#include "api/cncctl/question.h"

namespace cnc::ctl {
namespace {

struct AnswerArguments {
  std::vector<std::string> words;
  bool cancel = false;
};

api::Result<ExitCode> answer(const Context& context, bool confirmed,
                             const std::vector<GivenValue>& given) {
  const auto status = context.client.status();
  if (!status) return std::unexpected(status.error());
  // Nothing is asked: the server's refusal says what the machine does instead.
  if (!status->question) return done(context.client.answer(0, confirmed));
  const auto values = values_for(*status->question, given);
  if (!values) return std::unexpected(values.error());
  return done(context.client.answer(status->question->number, confirmed, *values));
}

}  // namespace

void add_answer_command(CLI::App& app, Task& task) {
  CLI::App& command = *app.add_subcommand(
      "answer", "Answer what the program asks: OK with these values, or --cancel");
  const auto arguments = std::make_shared<AnswerArguments>();
  command
      .add_option("values", arguments->words,
                  "Values of all fields in their order, or of some by their label; without any, "
                  "they stay as proposed")
      ->type_name("VALUE|LABEL=VALUE");
  command.add_flag("--cancel", arguments->cancel, "Cancel instead of OK");
  command.callback([&task, arguments] {
    if (arguments->cancel && !arguments->words.empty())
      throw CLI::ValidationError("answer takes either values or --cancel");
    task.action = [confirmed = !arguments->cancel, given = parse_given(arguments->words)](
                      const Context& context) { return answer(context, confirmed, given); };
  });
}

}  // namespace cnc::ctl
