// The numbered parameters #1 … #5799 of the G-code language (Eding manual 3.1.1).
//
// A plain array of doubles: get() and set() cost one memory access. Lengths inside (work offsets,
// G92, G28, G30 …) are always millimetres in machine coordinates, whatever unit the program uses.
// What survives power-off is the free range #4000 … #4999, the G28 and G30 positions, the G92
// offset, the active work system #5220, and the nine work systems with their rotations.
//
// Not thread-safe. load() and parse() check the whole file before they give out a store.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "config/axis.h"
#include "config/error.h"

namespace cnc::config {

/// Numbers with a fixed meaning. A number that stands for six is that of the X axis.
namespace parameter {
inline constexpr std::int32_t kFirst = 1;
inline constexpr std::int32_t kLast = 5799;
inline constexpr std::int32_t kFirstPersistent = 4000;
inline constexpr std::int32_t kLastPersistent = 4999;
inline constexpr std::int32_t kG28Position = 5161;
inline constexpr std::int32_t kG30Position = 5181;
inline constexpr std::int32_t kG92Offset = 5211;
inline constexpr std::int32_t kActiveSystem = 5220;
inline constexpr std::int32_t kWorkOffset = 5221;
inline constexpr std::int32_t kWorkRotation = 5230;
inline constexpr std::int32_t kWorkSystemStride = 20;
}  // namespace parameter

inline constexpr std::int32_t kWorkSystemCount = 9;  ///< G54 … G59.3
/// The ninth system has no rotation of its own: its number would be #5390, the spindle selection.
inline constexpr std::int32_t kWorkRotationCount = 8;

class ParameterStore {
 public:
  /// Everything 0, G54 active.
  ParameterStore();

  /// The stored file; a file that does not exist gives the values of a new store.
  [[nodiscard]] static Result<ParameterStore> load(const std::filesystem::path& path);
  /// Reads the format that to_text() writes; `name` is the file's name for errors.
  [[nodiscard]] static Result<ParameterStore> parse(std::string_view text, std::string_view name);

  [[nodiscard]] Result<void> save(const std::filesystem::path& path) const;
  /// One "number value" per line for each persistent parameter that is not 0.
  [[nodiscard]] std::string to_text() const;

  [[nodiscard]] static constexpr bool is_valid(std::int32_t number) {
    return number >= parameter::kFirst && number <= parameter::kLast;
  }
  [[nodiscard]] static bool is_persistent(std::int32_t number);

  /// `number` must be valid: whoever reads a program checks it first.
  [[nodiscard]] double get(std::int32_t number) const { return values_[index(number)]; }
  void set(std::int32_t number, double value) { values_[index(number)] = value; }

  /// 1 … 9 for G54 … G59.3. A program may write #5220; what is not a whole number in range reads
  /// as 1.
  [[nodiscard]] std::int32_t active_system() const;
  void set_active_system(std::int32_t system);
  /// Work offset of `system` 1 … 9.
  [[nodiscard]] Position work_offset(std::int32_t system) const;
  void set_work_offset(std::int32_t system, const Position& offset);
  [[nodiscard]] Position g92_offset() const { return six(parameter::kG92Offset); }
  void set_g92_offset(const Position& offset) { set_six(parameter::kG92Offset, offset); }
  [[nodiscard]] Position g28_position() const { return six(parameter::kG28Position); }
  void set_g28_position(const Position& position) { set_six(parameter::kG28Position, position); }
  [[nodiscard]] Position g30_position() const { return six(parameter::kG30Position); }
  void set_g30_position(const Position& position) { set_six(parameter::kG30Position, position); }

  /// Six consecutive parameters from `first` on as values of X … C.
  [[nodiscard]] Position six(std::int32_t first) const;
  void set_six(std::int32_t first, const Position& position);

  friend bool operator==(const ParameterStore&, const ParameterStore&) = default;

 private:
  // An index from outside the range lands on the unused element 0 instead of in foreign memory.
  static constexpr std::size_t index(std::int32_t number) {
    return is_valid(number) ? static_cast<std::size_t>(number) : 0;
  }

  std::array<double, parameter::kLast + 1> values_{};
};

}  // namespace cnc::config
