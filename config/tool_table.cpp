#include "config/tool_table.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <optional>

#include "config/atomic_file.h"
#include "config/text_lines.h"

namespace cnc::config {
namespace {

constexpr std::string_view kHeader =
    "; Tool table, one tool on each line, lengths in mm:\n"
    ";\n"
    ";   tool  length  xOffset  diameter  orientation  description\n"
    ";\n"
    "; tool 1-99; length is the Z offset that G43 adds, negative for a tool that is shorter than "
    "the\n"
    "; reference; xOffset and orientation (1-9) are for turning, 9 for every milling tool; the\n"
    "; description is the rest of the line. A tool that is not listed is all zero.\n";

constexpr std::size_t kNumberColumns = 5;

/// The numbers of a tool that have a range; one row serves the check and its message.
struct ToolField {
  std::string_view name;
  double (*value)(const Tool&);
  double min;
  double max;
};

constexpr std::array kFields{
    ToolField{"length", [](const Tool& tool) { return tool.length; }, -kMaxToolLength,
              kMaxToolLength},
    ToolField{"xOffset", [](const Tool& tool) { return tool.x_offset; }, -kMaxToolLength,
              kMaxToolLength},
    ToolField{"diameter", [](const Tool& tool) { return tool.diameter; }, -kMaxToolDiameter,
              kMaxToolDiameter},
    ToolField{"orientation", [](const Tool& tool) { return static_cast<double>(tool.orientation); },
              1.0, 9.0},
};

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

bool is_plain_text(std::string_view text) {
  return text.size() <= kMaxToolDescription && std::ranges::none_of(text, is_control);
}

/// What a line of the file says, before its values are checked.
struct Entry {
  std::int32_t number;
  Tool tool;
};

std::optional<Entry> parse_entry(std::string_view line) {
  const auto words = split_words(line);
  if (words.size() < kNumberColumns) return std::nullopt;
  const auto number = parse_integer(words[0]);
  const auto length = parse_number(words[1]);
  const auto x_offset = parse_number(words[2]);
  const auto diameter = parse_number(words[3]);
  const auto orientation = parse_integer(words[4]);
  if (!number || !length || !x_offset || !diameter || !orientation) return std::nullopt;
  const auto* description = words[4].data() + words[4].size();
  return Entry{*number,
               {*length, *x_offset, *diameter, *orientation,
                std::string(trimmed({description, line.data() + line.size()}))}};
}

}  // namespace

Result<ToolTable> ToolTable::load(const std::filesystem::path& path) {
  const auto text = read_text_file(path);
  if (text) return parse(*text, path.string());
  if (text.error().code == ErrorCode::file_not_found) return ToolTable{};
  return std::unexpected(text.error());
}

Result<ToolTable> ToolTable::parse(std::string_view text, std::string_view name) {
  const auto lines = split_lines(text, name);
  if (!lines) return std::unexpected(lines.error());
  ToolTable table;
  std::bitset<kMaxTool + 1> seen;
  for (const TextLine& line : *lines) {
    const auto content = trimmed(line.text);
    if (content.empty() || content.starts_with(';')) continue;
    const TextPlace place{std::string(name), line.number, 1};
    auto entry = parse_entry(content);
    if (!entry) {
      return fail(ErrorCode::tool_bad_line,
                  fmt::format("Read {}; a line is \"tool length xOffset diameter orientation "
                              "description\", for example \"1 0 0 6.35 9 End mill\".",
                              in_quotes(content)),
                  place);
    }
    const auto number = entry->number;
    auto taken = table.set(number, std::move(entry->tool));
    if (!taken) return fail(taken.error().code, std::move(taken.error().message), place);
    if (seen.test(static_cast<std::size_t>(number))) {
      return fail(ErrorCode::tool_duplicate,
                  fmt::format("Tool {} stands in the file twice.", number), place);
    }
    seen.set(static_cast<std::size_t>(number));
  }
  return table;
}

Result<void> ToolTable::save(const std::filesystem::path& path) const {
  return write_file_atomically(path, to_text());
}

std::string ToolTable::to_text() const {
  std::string text(kHeader);
  for (std::int32_t number = 1; number <= kMaxTool; ++number) {
    const Tool& row = tool(number);
    if (row == Tool{}) continue;
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {}{}{}\n", number,
                   number_text(row.length), number_text(row.x_offset), number_text(row.diameter),
                   row.orientation, row.description.empty() ? "" : " ", row.description);
  }
  return text;
}

const Tool& ToolTable::tool(std::int32_t number) const {
  return tools_[is_valid(number) ? static_cast<std::size_t>(number) : 0];
}

Result<void> ToolTable::check(std::int32_t number, const Tool& tool) {
  if (number < 1 || number > kMaxTool) {
    return fail(ErrorCode::tool_bad_number,
                fmt::format("Tool {} cannot be set; allowed are 1 to {}.", number, kMaxTool));
  }
  for (const ToolField& field : kFields) {
    const double value = field.value(tool);
    if (value >= field.min && value <= field.max) continue;
    return fail(ErrorCode::tool_bad_value,
                fmt::format("Tool {}: {} is {}; allowed is {} to {}.", number, field.name, value,
                            field.min, field.max));
  }
  if (!is_plain_text(tool.description)) {
    return fail(
        ErrorCode::tool_bad_value,
        fmt::format("Tool {}: the description {} is longer than {} bytes or holds a control "
                    "character.",
                    number, in_quotes(tool.description), kMaxToolDescription));
  }
  return {};
}

Result<void> ToolTable::set(std::int32_t number, Tool tool) {
  // Blanks at the ends would not survive the file.
  tool.description = std::string(trimmed(tool.description));
  auto allowed = check(number, tool);
  if (allowed) tools_[static_cast<std::size_t>(number)] = std::move(tool);
  return allowed;
}

}  // namespace cnc::config
