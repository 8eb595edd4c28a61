// Errors on stderr, one line or one JSON object each, and the exit code that follows from them.
#pragma once

#include <string_view>

#include "api/cncctl/context.h"
#include "api/error.h"

namespace cnc::ctl {

[[nodiscard]] ExitCode exit_code_of(api::ErrorKind kind);

/// "cncctl: <message> — <check>", or {"error": …} with --json.
void report(const api::Error& error, bool json);

/// A note on stderr that is no error: "cncctl: <text>".
void note(std::string_view text);

/// For a mistake in the command line.
[[nodiscard]] api::Error usage_error(std::string_view message);

}  // namespace cnc::ctl
