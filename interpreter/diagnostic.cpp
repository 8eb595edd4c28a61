#include "interpreter/diagnostic.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace cnc::interp {
namespace {

[[nodiscard]] bool is_utf8_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

/// Spaces (tabs stay tabs, a character of several bytes is one space) up to the wrong part, then
/// "^~~~".
[[nodiscard]] std::string underline(const Diagnostic& d) {
  std::string marks;
  const std::size_t begin = std::min<std::size_t>(d.column - 1, d.line_text.size());
  for (const char c : d.line_text.substr(0, begin)) {
    if (!is_utf8_continuation(c)) marks += c == '\t' ? '\t' : ' ';
  }
  marks += '^';
  const std::string wrong = d.line_text.substr(begin, d.length);
  const auto characters =
      std::ranges::count_if(wrong, [](char c) { return !is_utf8_continuation(c); });
  if (characters > 1) marks.append(static_cast<std::size_t>(characters - 1), '~');
  return marks;
}

}  // namespace

std::string Diagnostic::to_string() const {
  std::string text = fmt::format("{}:{}:{}: {}: {} [E{}]\n", file, line, column,
                                 severity == Severity::error ? "error" : "warning", sentence,
                                 static_cast<unsigned>(code));
  if (!line_text.empty()) fmt::format_to(std::back_inserter(text), "  {}\n", line_text);
  if (!line_text.empty() && column > 0) {
    fmt::format_to(std::back_inserter(text), "  {}\n", underline(*this));
  }
  if (!allowed.empty()) fmt::format_to(std::back_inserter(text), "  allowed: {}\n", allowed);
  for (const CallSite& call : call_stack) {
    fmt::format_to(std::back_inserter(text), "  in sub {}, called from {}:{}\n", call.sub,
                   call.file, call.line);
  }
  return text;
}

Error Diagnostic::to_error() const {
  const std::string separator = allowed.empty() ? "" : " Allowed: ";
  return Error{code, sentence + separator + allowed, TextPlace{file, line, column}};
}

}  // namespace cnc::interp
