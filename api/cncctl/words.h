// Words of the command line, taken apart.
#pragma once

#include <string_view>

namespace cnc::ctl {

/// "-2.5"; throws CLI::ValidationError for anything that is not a number from end to end.
[[nodiscard]] double parse_number(std::string_view word);

}  // namespace cnc::ctl
