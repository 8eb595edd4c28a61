// The one kind of error that crosses a module boundary.
//
// Every error has a stable code from the table in error_table.def, a sentence for the operator that
// says what was wrong and what would be right, and, when it comes from a text (a program or a
// configuration), the place in that text. Exceptions do not cross a module.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace cnc {

enum class ErrorCode : std::uint16_t {
#define CNC_ERROR(number, name, sentence, check) name = number,
#include "config/error_table.def"
#undef CNC_ERROR
};

/// A row of the error table: what the documents, the API and the screen show for a code.
struct ErrorInfo {
  ErrorCode code;
  std::string_view name;      ///< stable identifier, for example "config_value_out_of_range"
  std::string_view sentence;  ///< what happened, in general
  std::string_view check;     ///< what the operator should look at
};

/// All rows, ascending by code.
[[nodiscard]] std::span<const ErrorInfo> error_table();
[[nodiscard]] const ErrorInfo& error_info(ErrorCode code);
/// The whole table as docs/errors.md.
[[nodiscard]] std::string errors_as_markdown();

/// A place in a text file. Line and column count from 1; 0 means "not known".
struct TextPlace {
  std::string file;
  std::uint32_t line = 0;
  std::uint32_t column = 0;

  friend bool operator==(const TextPlace&, const TextPlace&) = default;
};

struct Error {
  ErrorCode code{};
  std::string message;  ///< the full sentence with the values of this case
  std::optional<TextPlace> place;

  /// "file:line:column: message [E1003]"; what is not known of the place is left out.
  [[nodiscard]] std::string to_string() const;
};

template <typename T>
using Result = std::expected<T, Error>;

/// For `return fail(ErrorCode::x, "...");` in a function that returns a Result.
[[nodiscard]] inline std::unexpected<Error> fail(ErrorCode code, std::string message) {
  return std::unexpected(Error{code, std::move(message), std::nullopt});
}
[[nodiscard]] inline std::unexpected<Error> fail(ErrorCode code, std::string message,
                                                 TextPlace place) {
  return std::unexpected(Error{code, std::move(message), std::move(place)});
}

}  // namespace cnc
