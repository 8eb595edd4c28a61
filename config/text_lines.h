// Reading the operator-editable text files of this room: bounded files, bounded lines, exact
// numbers.
//
// A byte order mark and the line ends of Windows are accepted, so a file may come from any editor.
// All three parsers (settings, parameters, tools) stand on these few functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/error.h"

namespace cnc::config {

inline constexpr std::size_t kMaxTextFileSize = 1024 * 1024;  ///< bytes
inline constexpr std::size_t kMaxTextLineLength = 1000;       ///< bytes without the line end

/// The whole file; refused when it is missing, not a regular file, or larger than the bound.
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& path);

/// One line of a text. `text` is a view into the text, without its line end.
struct TextLine {
  std::uint32_t number = 0;  ///< from 1
  std::string_view text;
};

/// All lines of `text`; `name` is the file's name for errors. Refused when a bound is exceeded.
[[nodiscard]] Result<std::vector<TextLine>> split_lines(std::string_view text,
                                                        std::string_view name);

[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The words of a line, separated by spaces and tabs.
[[nodiscard]] std::vector<std::string_view> split_words(std::string_view text);

/// The finite number that `text` is, from its first to its last character, whatever the locale.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);
[[nodiscard]] std::optional<std::int32_t> parse_integer(std::string_view text);

/// The shortest decimal text that parse_number() turns into the same double again.
[[nodiscard]] std::string number_text(double value);

/// Text of unknown origin for an error message: bounded, without control characters, in quotes.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace cnc::config
