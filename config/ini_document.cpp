#include "config/ini_document.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

#include "config/text_lines.h"

namespace cnc::config {
namespace {

/// Without the comment at its end; in a value in quotes ; and # are letters.
std::string_view without_comment(std::string_view line) {
  constexpr std::string_view kSigns = ";#";
  const auto equals = line.find('=');
  const auto value =
      equals == std::string_view::npos ? equals : line.find_first_not_of(" \t", equals + 1);
  std::size_t from = 0;
  if (value != std::string_view::npos && line[value] == '"' &&
      line.find_first_of(kSigns) > equals) {
    const auto closing = line.find('"', value + 1);
    if (closing != std::string_view::npos) from = closing;
  }
  return line.substr(0, line.find_first_of(kSigns, from));
}

/// Reads line after line into a document.
class Reader {
 public:
  Reader(std::string_view text, std::string_view name) : text_(text), name_(name) {}

  IniDocument read() {
    const auto lines = split_lines(text_, name_);
    if (!lines) return {{}, {}, {lines.error()}};
    for (const TextLine& line : *lines) {
      if (document_.errors.size() >= kMaxIniErrors) break;
      read_line(line);
    }
    return std::move(document_);
  }

 private:
  void read_line(const TextLine& line) {
    const auto content = trimmed(without_comment(line.text));
    if (content.empty()) return;
    if (content.starts_with('[')) {
      read_section(content, line);
    } else {
      read_entry(content, line);
    }
    if (!document_.sections.empty()) document_.sections.back().end = end_of(line);
  }

  void read_section(std::string_view content, const TextLine& line) {
    const auto name = trimmed(content.substr(1, content.size() - 2));
    if (!content.ends_with(']') || name.empty()) return refuse(content, line, "\"[SECTION]\"");
    document_.sections.push_back({name, place(line, name), 0});
  }

  void read_entry(std::string_view content, const TextLine& line) {
    const auto equals = content.find('=');
    const auto key = trimmed(content.substr(0, equals));
    if (equals == std::string_view::npos || key.empty()) {
      return refuse(content, line, "\"[SECTION]\" or \"key = value\"");
    }
    if (document_.sections.empty()) return refuse(content, line, "a \"[SECTION]\" before any key");
    const auto value = trimmed(content.substr(equals + 1));
    document_.entries.push_back({document_.sections.back().name, key, value, place(line, value)});
  }

  void refuse(std::string_view content, const TextLine& line, std::string_view allowed) {
    document_.errors.push_back({ErrorCode::config_bad_line,
                                fmt::format("Read {}; allowed is {}.", in_quotes(content), allowed),
                                place(line, content)});
  }

  [[nodiscard]] TextPlace place(const TextLine& line, std::string_view part) const {
    const auto column = static_cast<std::uint32_t>(part.data() - line.text.data() + 1);
    return {std::string(name_), line.number, column};
  }

  [[nodiscard]] std::size_t end_of(const TextLine& line) const {
    const auto behind =
        static_cast<std::size_t>(line.text.data() - text_.data()) + line.text.size();
    const auto newline = text_.find('\n', behind);
    return newline == std::string_view::npos ? text_.size() : newline + 1;
  }

  std::string_view text_;
  std::string_view name_;
  IniDocument document_;
};

}  // namespace

IniDocument parse_ini(std::string_view text, std::string_view name) {
  return Reader(text, name).read();
}

std::string with_edits(std::string_view text, std::vector<TextEdit> edits) {
  std::ranges::stable_sort(edits, {}, &TextEdit::offset);
  std::string result;
  std::size_t done = 0;
  for (const TextEdit& edit : edits) {
    result += text.substr(done, edit.offset - done);
    result += edit.replacement;
    done = edit.offset + edit.length;
  }
  result += text.substr(done);
  return result;
}

}  // namespace cnc::config
