// From reset to main(): memory, constructors, and the table of interrupts.
#include <algorithm>
#include <array>
#include <cstdint>

#include "hal/cpu5/target/mps2_an385/interrupts.h"

int main();

extern "C" {

// The linker's places (mps2_an385.ld).
extern std::uint32_t __stack_top, __data_load, __data_start, __data_end, __bss_start, __bss_end;
extern void (*__init_array_start[])();
extern void (*__init_array_end[])();

void reset() {
  std::copy(&__data_load, &__data_load + (&__data_end - &__data_start), &__data_start);
  std::fill(&__bss_start, &__bss_end, 0U);
  std::for_each(__init_array_start, __init_array_end, [](auto constructor) { constructor(); });
  main();
}

// A processor that has lost its way makes no more steps: outputs keep their last state until the
// watchdog of the drives' supply or the operator's estop ends it. It never goes on.
[[noreturn]] void halt() {
  asm volatile("cpsid i");
  while (true) asm volatile("wfi");
}

[[noreturn]] void __cxa_pure_virtual() { halt(); }
}

namespace {

union Vector {
  std::uint32_t* stack;
  void (*handler)();
};

constexpr std::size_t kPendSv = 14;
constexpr std::size_t kFirstInterrupt = 16;
constexpr std::size_t kVectors = kFirstInterrupt + 32;

consteval std::array<Vector, kVectors> make_vectors() {
  using namespace cnc::hal::cpu5::target;
  std::array<Vector, kVectors> vectors{};
  for (Vector& vector : vectors) vector.handler = halt;
  vectors[0].stack = &__stack_top;
  vectors[1].handler = reset;
  vectors[kPendSv].handler = planning_interrupt;
  vectors[kFirstInterrupt + kTimer1Number].handler = step_interrupt;
  return vectors;
}

[[gnu::section(".vectors"), gnu::used]] constinit const std::array<Vector, kVectors> kVectorTable =
    make_vectors();

}  // namespace
