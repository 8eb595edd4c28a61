// Counts the allocations of the whole program: a test that links this has its own operator new.
#pragma once

#include <cstddef>

namespace cnc::test {

/// How often any thread has allocated so far.
[[nodiscard]] std::size_t allocations();

/// And the calling one.
[[nodiscard]] std::size_t allocations_of_this_thread();

}  // namespace cnc::test
