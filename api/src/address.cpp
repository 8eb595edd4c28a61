// Where a server is looked for when nobody says.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <unistd.h>

#include "api/client.h"

namespace cnc::api {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

std::string default_address() {
  if (std::string address = environment("CNC_SERVER"); !address.empty()) return address;
  const std::string runtime = environment("XDG_RUNTIME_DIR");
  std::error_code ignored;
  if (!runtime.empty() && std::filesystem::is_directory(runtime, ignored)) {
    return "unix://" + runtime + "/cncserver.sock";
  }
  return "unix:///tmp/cncserver-" + std::to_string(getuid()) + ".sock";
}

}  // namespace cnc::api
