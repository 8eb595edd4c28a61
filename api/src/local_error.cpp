#include "api/src/local_error.h"

#include <algorithm>
#include <array>
#include <utility>

namespace cnc::api {
namespace {

constexpr std::array kLocalErrors{
    LocalError{ErrorKind::unavailable, 6001, "server_unavailable",
               "Whether cncserver runs, and its address: option --server or variable CNC_SERVER."},
    LocalError{ErrorKind::timed_out, 6002, "no_answer_in_time",
               "The machine's state before the command is given again: it may have been executed."},
    LocalError{ErrorKind::incompatible, 6003, "api_version_mismatch",
               "That client and server come from the same release; update the older one."},
    LocalError{ErrorKind::cancelled, 6004, "call_cancelled",
               "Nothing, if you cancelled it; the machine stops."},
};

}  // namespace

std::span<const LocalError> local_errors() { return kLocalErrors; }

Error make_local_error(ErrorKind kind, std::string message) {
  Error error{.kind = kind, .message = std::move(message)};
  const auto row = std::ranges::find(kLocalErrors, kind, &LocalError::kind);
  if (row != kLocalErrors.end()) {
    error.code = row->code;
    error.name = row->name;
    error.check = row->check;
  }
  return error;
}

}  // namespace cnc::api
