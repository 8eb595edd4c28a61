// The main() of every Catch2 test program.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <limits>
#include <malloc.h>

int main(int argc, char** argv) {
  // Tests make machines by the thousand, each with megabytes of queues: what one has freed the next
  // one takes, instead of the kernel clearing pages anew (of the fault tables two thirds of the
  // time).
  mallopt(M_MMAP_THRESHOLD, 32 * 1024 * 1024);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  return Catch::Session().run(argc, argv);
}
