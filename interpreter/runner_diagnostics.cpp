// What goes wrong in a line: with the file, the line, and the calls that led there.
#include <ranges>

#include "interpreter/line_parser.h"
#include "interpreter/runner.h"

namespace cnc::interp {

std::string_view Runner::file_name(std::uint16_t file) const {
  if (file >= sources_.count() || (file == Sources::kJob && !sources_.has_job())) return {};
  return sources_.file(file).name();
}

CallSite Runner::site_of(const Call& call) const {
  const std::string_view text = sources_.file(call.sub.file).line(call.sub.begin->line);
  return {.sub = std::string(leading_name(find_keyword(text).rest)),
          .file = std::string(file_name(call.file)),
          .line = call.line};
}

Diagnostic Runner::diagnostic_of(const Refusal& refusal, Severity severity) const {
  Diagnostic diagnostic{.code = refusal.code,
                        .severity = severity,
                        .sentence = refusal.sentence,
                        .allowed = refusal.allowed,
                        .file = program_->name(),
                        .line = line_number_,
                        .column = refusal.span.column,
                        .length = refusal.span.length,
                        .line_text = std::string(line_text_.substr(0, kMaxLineLength)),
                        .call_stack = {}};
  for (const Call& call : calls_ | std::views::reverse) {
    diagnostic.call_stack.push_back(site_of(call));
  }
  return diagnostic;
}

Progress Runner::fail(const Refusal& refusal) {
  failed_ = true;
  rest_.reset();
  diagnostic_ = diagnostic_of(refusal, Severity::error);
  return Progress::failed;
}

Accepted Runner::tolerate(Habit habit, Span span) {
  // A dialect that ignores codes is not against the manual: it is the manual.
  if (settings_.strict && habit != Habit::ignored_code) return refuse_habit(habit, span);
  const auto bit = static_cast<std::size_t>(habit);
  if (habits_seen_.test(bit)) return {};
  habits_seen_.set(bit);
  warnings_.push_back(diagnostic_of(refuse_habit(habit, span).error(), Severity::warning));
  return {};
}

void Runner::note_library(const Refusal& refusal) {
  constexpr std::size_t kMaxWarnings = 100;
  if (library_warnings_.size() >= kMaxWarnings) return;
  library_warnings_.push_back(diagnostic_of(refusal, Severity::warning));
}

}  // namespace cnc::interp
