// Typo help: which known name was probably meant.
#pragma once

#include <span>
#include <string_view>

namespace cnc::config {

/// The candidate that takes the fewest inserted, removed or changed letters to become `name`,
/// capitals not counted; the first of equals. `candidates` is not empty.
[[nodiscard]] std::string_view nearest_name(std::string_view name,
                                            std::span<const std::string_view> candidates);

}  // namespace cnc::config
