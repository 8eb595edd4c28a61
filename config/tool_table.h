// The tools T1 … T99 (Eding manual 2.6): lengths, diameter, lathe orientation and description.
//
// Tool 0 is "no tool": it is always there, all zero, and cannot be changed. A value that set() or
// load() lets in is within its range, so cutter compensation and tool length need not check again.
// Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "config/error.h"

namespace cnc::config {

inline constexpr std::int32_t kMaxTool = 99;
inline constexpr double kMaxToolLength = 10'000.0;      ///< mm, either sign
inline constexpr double kMaxToolDiameter = 1'000.0;     ///< mm, either sign
inline constexpr std::size_t kMaxToolDescription = 80;  ///< bytes of UTF-8
/// Orientation without any offset of the controlled point (manual 3.1.2.1): every milling tool.
inline constexpr std::int32_t kCentredOrientation = 9;

struct Tool {
  double length = 0.0;    ///< Z offset; negative for a tool shorter than the reference
  double x_offset = 0.0;  ///< for turning
  /// Negative: by so much smaller than the tool that a program's path was made for (manual 5.3).
  double diameter = 0.0;
  std::int32_t orientation = kCentredOrientation;  ///< 1 … 9, for turning
  std::string description{};

  friend bool operator==(const Tool&, const Tool&) = default;
};

class ToolTable {
 public:
  /// The stored file; a file that does not exist gives an empty table.
  [[nodiscard]] static Result<ToolTable> load(const std::filesystem::path& path);
  /// Reads the format that to_text() writes; `name` is the file's name for errors.
  [[nodiscard]] static Result<ToolTable> parse(std::string_view text, std::string_view name);

  [[nodiscard]] Result<void> save(const std::filesystem::path& path) const;
  /// "number length xOffset diameter orientation description", one line for each tool that is set.
  [[nodiscard]] std::string to_text() const;

  [[nodiscard]] static constexpr bool is_valid(std::int32_t number) {
    return number >= 0 && number <= kMaxTool;
  }

  /// Tool 0 … 99; any other number gives tool 0, and whoever reads a program refuses it first.
  [[nodiscard]] const Tool& tool(std::int32_t number) const;
  /// What set() would say.
  [[nodiscard]] static Result<void> check(std::int32_t number, const Tool& tool);
  /// Tool 1 … 99. Refused, and nothing changed, when the number or a value is out of range.
  Result<void> set(std::int32_t number, Tool tool);

  friend bool operator==(const ToolTable&, const ToolTable&) = default;

 private:
  std::array<Tool, kMaxTool + 1> tools_;
};

}  // namespace cnc::config
