// What every command of cncctl gets and what it answers.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "api/client.h"

namespace cnc::ctl {

/// Documented in --help and docs/cncctl.md; scripts rely on them.
enum class ExitCode : std::uint8_t {
  ok = 0,
  refused = 1,        ///< the machine refused, or the job did not reach its end
  usage = 2,          ///< wrong command line
  no_server = 3,      ///< no server, no answer in time, or the connection was lost
  incompatible = 4,   ///< another version of the API
  interrupted = 130,  ///< Ctrl-C
};

struct GlobalOptions {
  std::string address = api::default_address();
  double timeout = 10.0;  ///< s per call
  bool json = false;
};

struct Context {
  const GlobalOptions& options;
  const api::Client& client;
  std::stop_token interrupted;  ///< requested by Ctrl-C
};

/// ok, if the call succeeded.
[[nodiscard]] inline api::Result<ExitCode> done(const api::Result<void>& result) {
  if (!result) return std::unexpected(result.error());
  return ExitCode::ok;
}

using Action = std::function<api::Result<ExitCode>(const Context&)>;

/// What the command line asks for.
struct Task {
  GlobalOptions options;
  Action action;
  bool needs_server = true;      ///< connect, and compare versions, before the action
  std::string when_interrupted;  ///< what Ctrl-C means for the machine
};

}  // namespace cnc::ctl
