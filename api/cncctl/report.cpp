#include "api/cncctl/report.h"

#include <cstdio>
#include <fmt/format.h>

#include "api/cncctl/json.h"

namespace cnc::ctl {

ExitCode exit_code_of(api::ErrorKind kind) {
  switch (kind) {
    case api::ErrorKind::refused:
    case api::ErrorKind::invalid:
    case api::ErrorKind::failed:
    case api::ErrorKind::cancelled:
    case api::ErrorKind::unsupported:
    case api::ErrorKind::denied:
      return ExitCode::refused;
    case api::ErrorKind::unavailable:
    case api::ErrorKind::timed_out:
      return ExitCode::no_server;
    case api::ErrorKind::incompatible:
      return ExitCode::incompatible;
  }
  return ExitCode::refused;
}

void report(const api::Error& error, bool json) {
  if (json) {
    fmt::print(stderr, "{}\n", nlohmann::json{{"error", to_json(error)}}.dump());
  } else if (error.check.empty()) {
    fmt::print(stderr, "cncctl: {}\n", error.to_string());
  } else {
    fmt::print(stderr, "cncctl: {} — {}\n", error.to_string(), error.check);
  }
}

void note(std::string_view text) { fmt::print(stderr, "cncctl: {}\n", text); }

api::Error usage_error(std::string_view message) {
  return {.kind = api::ErrorKind::invalid,
          .name = "wrong_usage",
          .message = std::string(message),
          .check = "See cncctl --help."};
}

}  // namespace cnc::ctl
