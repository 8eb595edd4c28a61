#pragma once

#include <chrono>

namespace cnc::test {

/// No test waits longer than this for anything; far more than anything takes.
inline constexpr std::chrono::seconds kPatience{30};

}  // namespace cnc::test
