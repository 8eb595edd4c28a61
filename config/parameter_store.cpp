#include "config/parameter_store.h"

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
    "; Numbered parameters that survive power-off: \"number value\" on each line.\n"
    "; Lengths are mm and degrees in machine coordinates. What is not listed is 0.\n"
    ";\n"
    "; 4000-4999 free to use          5161-5166 G28 position   5181-5186 G30 position\n"
    "; 5211-5216 G92 offset           5220 active system, 1 = G54 ... 9 = G59.3\n"
    "; 5221-5226 G54 offset, the next systems 20 further each; 5230, 5250 ... rotation\n";

/// A run of numbers that persist.
struct Range {
  std::int32_t first;
  std::int32_t count;
};

constexpr std::int32_t kAxes = static_cast<std::int32_t>(kAxisCount);
constexpr std::array kPersistentRanges{
    Range{parameter::kFirstPersistent,
          parameter::kLastPersistent - parameter::kFirstPersistent + 1},
    Range{parameter::kG28Position, kAxes},
    Range{parameter::kG30Position, kAxes},
    Range{parameter::kG92Offset, kAxes},
    Range{parameter::kActiveSystem, 1},
};

constexpr std::int32_t work_offset_number(std::int32_t system) {
  return parameter::kWorkOffset + (system - 1) * parameter::kWorkSystemStride;
}

bool is_system(double value) {
  return value >= 1 && value <= kWorkSystemCount && value == std::floor(value);
}

bool belongs_to_work_system(std::int32_t number) {
  const std::int32_t from_first = number - parameter::kWorkOffset;
  if (from_first < 0) return false;
  const std::int32_t system = from_first / parameter::kWorkSystemStride + 1;
  const std::int32_t slot = from_first % parameter::kWorkSystemStride;
  const bool is_offset = slot < kAxes && system <= kWorkSystemCount;
  const bool is_rotation =
      slot == parameter::kWorkRotation - parameter::kWorkOffset && system <= kWorkRotationCount;
  return is_offset || is_rotation;
}

/// One "number value" line, a comment behind ';' already cut off.
struct Entry {
  std::int32_t number;
  double value;
};

Result<Entry> parse_entry(std::string_view line, const TextPlace& place) {
  const auto words = split_words(line);
  const auto number = words.empty() ? std::nullopt : parse_integer(words[0]);
  if (words.size() != 2 || !number) {
    return fail(ErrorCode::parameter_bad_line,
                fmt::format("Read {}; a line is \"number value\", for example \"5221 100.5\".",
                            in_quotes(line)),
                place);
  }
  if (!ParameterStore::is_persistent(*number)) {
    return fail(ErrorCode::parameter_not_persistent,
                fmt::format("#{} is not a stored parameter; stored are 4000-4999, 5161-5166, "
                            "5181-5186, 5211-5216, 5220 and the work systems from 5221 on.",
                            *number),
                place);
  }
  const auto value = parse_number(words[1]);
  if (!value) {
    return fail(ErrorCode::parameter_bad_value,
                fmt::format("#{}: read {}; allowed is a finite decimal number.", *number,
                            in_quotes(words[1])),
                place);
  }
  if (*number == parameter::kActiveSystem && !is_system(*value)) {
    return fail(ErrorCode::parameter_bad_value,
                fmt::format("#{}: read {}; allowed is a whole number from 1 (G54) to 9 (G59.3).",
                            *number, in_quotes(words[1])),
                place);
  }
  return Entry{*number, *value};
}

}  // namespace

ParameterStore::ParameterStore() { set_active_system(1); }

bool ParameterStore::is_persistent(std::int32_t number) {
  const bool in_range = std::ranges::any_of(kPersistentRanges, [number](const Range& range) {
    return number >= range.first && number < range.first + range.count;
  });
  return in_range || belongs_to_work_system(number);
}

Result<ParameterStore> ParameterStore::load(const std::filesystem::path& path) {
  const auto text = read_text_file(path);
  if (text) return parse(*text, path.string());
  if (text.error().code == ErrorCode::file_not_found) return ParameterStore{};
  return std::unexpected(text.error());
}

Result<ParameterStore> ParameterStore::parse(std::string_view text, std::string_view name) {
  const auto lines = split_lines(text, name);
  if (!lines) return std::unexpected(lines.error());
  ParameterStore store;
  std::bitset<parameter::kLast + 1> seen;
  for (const TextLine& line : *lines) {
    const auto content = trimmed(line.text.substr(0, line.text.find(';')));
    if (content.empty()) continue;
    const TextPlace place{std::string(name), line.number, 1};
    const auto entry = parse_entry(content, place);
    if (!entry) return std::unexpected(entry.error());
    if (seen.test(index(entry->number))) {
      return fail(ErrorCode::parameter_duplicate,
                  fmt::format("#{} stands in the file twice.", entry->number), place);
    }
    seen.set(index(entry->number));
    store.set(entry->number, entry->value);
  }
  return store;
}

Result<void> ParameterStore::save(const std::filesystem::path& path) const {
  return write_file_atomically(path, to_text());
}

std::string ParameterStore::to_text() const {
  std::string text(kHeader);
  for (std::int32_t number = parameter::kFirst; number <= parameter::kLast; ++number) {
    const double value = number == parameter::kActiveSystem ? active_system() : get(number);
    // A program can compute an infinity into a free parameter; the file holds numbers only.
    if (!is_persistent(number) || value == 0.0 || !std::isfinite(value)) continue;
    fmt::format_to(std::back_inserter(text), "{} {:.17g}\n", number, value);
  }
  return text;
}

std::int32_t ParameterStore::active_system() const {
  const double value = get(parameter::kActiveSystem);
  return is_system(value) ? static_cast<std::int32_t>(value) : 1;
}

void ParameterStore::set_active_system(std::int32_t system) {
  set(parameter::kActiveSystem, system);
}

Position ParameterStore::work_offset(std::int32_t system) const {
  return six(work_offset_number(system));
}

void ParameterStore::set_work_offset(std::int32_t system, const Position& offset) {
  set_six(work_offset_number(system), offset);
}

Position ParameterStore::six(std::int32_t first) const {
  Position position;
  for (const Axis axis : kAllAxes) {
    position[axis] = get(first + static_cast<std::int32_t>(index_of(axis)));
  }
  return position;
}

void ParameterStore::set_six(std::int32_t first, const Position& position) {
  for (const Axis axis : kAllAxes) {
    set(first + static_cast<std::int32_t>(index_of(axis)), position[axis]);
  }
}

}  // namespace cnc::config
