// The messages of a machine under test belong to the test, not to the terminal.
#include <spdlog/spdlog.h>

namespace {

[[maybe_unused]] const bool kQuiet = [] {
  spdlog::set_level(spdlog::level::off);
  return true;
}();

}  // namespace
