// What a call answers instead of its result.
//
// The numbers, names and the advice are the project's one error table (docs/errors.md): the server
// sends them with every refusal. Errors that arise on this side of the wire (no server, time-out,
// another API version, cancelled) have numbers of the same table.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>

namespace cnc::api {

/// What a client can do about an error. The number says what happened exactly.
enum class ErrorKind : std::uint8_t {
  refused,       ///< the machine's present state does not allow it; `message` says what it needs
  invalid,       ///< a value or text of the request is wrong; `place` says where, if it is a text
  failed,        ///< it was begun and did not reach its end
  unavailable,   ///< no server at this address, or the connection was lost
  timed_out,     ///< no answer within the deadline; whether the command was executed is not known
  cancelled,     ///< by the caller's stop token
  incompatible,  ///< the server speaks another major version of the API
  unsupported,   ///< this server, or the board behind it, has no such function
  denied,        ///< this client may not do that
};

/// A place in a text file of the server's computer. Counts from 1; 0 = not known.
struct TextPlace {
  std::string file;
  std::uint32_t line = 0;
  std::uint32_t column = 0;

  friend bool operator==(const TextPlace&, const TextPlace&) = default;
};

struct Error {
  ErrorKind kind = ErrorKind::failed;
  std::uint32_t code = 0;  ///< stable number, 0 if the server gave none
  std::string name{};      ///< stable identifier, for example "command_not_allowed"
  std::string message{};   ///< sentence for the operator, with the values of this case
  std::string check{};     ///< what to look at; may be empty
  std::optional<TextPlace> place{};

  /// "file:line:column: message [E5001]", without what is not known.
  [[nodiscard]] std::string to_string() const;

  friend bool operator==(const Error&, const Error&) = default;
};

/// "refused" … "denied".
[[nodiscard]] std::string_view name_of(ErrorKind kind);

template <typename T>
using Result = std::expected<T, Error>;

}  // namespace cnc::api
