#include "config/text_lines.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>

namespace cnc::config {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlank = " \t";
constexpr std::size_t kMaxQuoted = 60;

// from_chars, unlike strtod, ignores the locale and takes no leading blanks; people do write "+1".
template <typename T>
std::optional<T> parse_whole(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::unexpected<Error> line_too_long(std::string_view name, std::uint32_t number) {
  return fail(ErrorCode::text_line_too_long,
              fmt::format("The line is longer than {} characters.", kMaxTextLineLength),
              TextPlace{std::string(name), number, 1});
}

}  // namespace

Result<std::string> read_text_file(const std::filesystem::path& path) {
  std::error_code status_error;
  const auto status = std::filesystem::status(path, status_error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return fail(ErrorCode::file_not_found, fmt::format("{} does not exist.", path.string()));
  }
  // A pipe or a device would block or never end.
  if (!std::filesystem::is_regular_file(status)) {
    return fail(ErrorCode::file_not_readable,
                fmt::format("{} is not a regular file.", path.string()));
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text(kMaxTextFileSize + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || (stream.fail() && !stream.eof())) {
    return fail(ErrorCode::file_not_readable, fmt::format("{} cannot be read.", path.string()));
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxTextFileSize) {
    return fail(ErrorCode::text_file_too_large,
                fmt::format("{} is larger than {} bytes.", path.string(), kMaxTextFileSize));
  }
  return text;
}

Result<std::vector<TextLine>> split_lines(std::string_view text, std::string_view name) {
  if (text.size() > kMaxTextFileSize) {
    return fail(ErrorCode::text_file_too_large,
                fmt::format("{} is larger than {} bytes.", name, kMaxTextFileSize));
  }
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<TextLine> lines;
  while (!text.empty()) {
    const auto number = static_cast<std::uint32_t>(lines.size() + 1);
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.size() > kMaxTextLineLength) return line_too_long(name, number);
    lines.push_back({number, line});
  }
  return lines;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return text.substr(0, 0);
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> split_words(std::string_view text) {
  std::vector<std::string_view> words;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const auto length = std::min(text.find_first_of(kBlank), text.size());
    words.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return words;
}

std::optional<double> parse_number(std::string_view text) {
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int32_t> parse_integer(std::string_view text) {
  return parse_whole<std::int32_t>(text);
}

std::string number_text(double value) { return fmt::format("{}", value); }

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, kMaxQuoted)) {
    const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    result += is_control ? '?' : c;
  }
  if (text.size() > kMaxQuoted) result += "...";
  return result + '"';
}

}  // namespace cnc::config
