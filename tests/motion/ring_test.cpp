#include "motion/ring.h"

#include <catch2/catch.hpp>

namespace cnc::motion::test {

TEST_CASE("A ring keeps the indices of its elements while it is emptied and filled", "[MOT-1]") {
  Ring<int> ring(4);
  for (int i = 0; i < 1000; ++i) {
    ring.push_back(i);
    if (ring.size() == 4) ring.pop_front();
    for (std::uint64_t k = ring.first(); k != ring.end(); ++k) {
      REQUIRE(ring[k] == static_cast<int>(k));
    }
  }
  ring.pop_back();
  CHECK(ring.back() == 998);
}

TEST_CASE("A ring that grows keeps elements and indices", "[MOT-1]") {
  Ring<int> ring(4);
  for (int i = 0; i < 7; ++i) {
    ring.reserve(ring.size() + 1);
    ring.push_back(i);
    if (i == 2) ring.pop_front();
  }
  CHECK(ring.first() == 1);
  CHECK(ring.front() == 1);
  CHECK(ring[6] == 6);
  CHECK(ring.free() == 2);
}

}  // namespace cnc::motion::test
