#include "config/nearest_name.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace cnc::config {
namespace {

// Names are short; a longer word is noise, and its tail would only cost time.
constexpr std::size_t kMaxCompared = 40;

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Levenshtein's distance, one row of the matrix at a time (Wagner and Fischer 1974).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::array<std::size_t, kMaxCompared + 1> row{};
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (lower(a[i]) == lower(b[j]) ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string_view nearest_name(std::string_view name, std::span<const std::string_view> candidates) {
  return *std::ranges::min_element(candidates, {}, [name](std::string_view candidate) {
    return edit_distance(name.substr(0, kMaxCompared), candidate.substr(0, kMaxCompared));
  });
}

}  // namespace cnc::config
