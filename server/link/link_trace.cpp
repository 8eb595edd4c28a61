#include "server/link/link_trace.h"

#include <fmt/chrono.h>
#include <utility>

#include "config/ini_file.h"
#include "server/version.h"

namespace cnc::server {

hal::trace::About about_machine(const config::MachineConfig& config, std::string board) {
  return {.reason = {},
          .written = {},
          .server = kServerVersion,
          .board = std::move(board),
          .driver = hal::cpu5::driver_settings(config),
          .config = config::machine_config_text(config)};
}

std::string utc_text(std::chrono::system_clock::time_point time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(time - seconds).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)), milliseconds);
}

}  // namespace cnc::server
