#include "api/cncctl/words.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace cnc::ctl {

double parse_number(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    throw CLI::ValidationError(fmt::format("\"{}\" is not a number", word));
  }
  return value;
}

}  // namespace cnc::ctl
