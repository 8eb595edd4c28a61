// The files that a new machine starts with, built into the program: config/ of the source tree.
#pragma once

#include <string_view>

namespace cnc::server {

[[nodiscard]] std::string_view shipped_cnc_ini();
[[nodiscard]] std::string_view shipped_parameters();
[[nodiscard]] std::string_view shipped_tools();
[[nodiscard]] std::string_view shipped_macros();

}  // namespace cnc::server
