// A plain motion line allocates nothing, and neither does a round of a loop.
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>

#include "tests/interpreter/support.h"

namespace {

std::atomic<std::size_t> allocations{0};

}  // namespace

// All forms that libstdc++ and Catch2 use, so that what one allocates the other frees.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return std::malloc(size);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }

using namespace cnc;
using namespace cnc::interp;

namespace {

/// Allocations of all next() calls but those of the first `warm_up` commands.
std::size_t allocations_of(const std::string& text, int warm_up) {
  const auto program = Program::from_text(text, "plain").value();
  config::ParameterStore parameters;
  config::ToolTable tools;
  Interpreter interpreter({}, parameters, tools);
  interpreter.start(program, {});
  for (int i = 0; i < warm_up; ++i) REQUIRE(interpreter.next() == Progress::command);
  const std::size_t before = allocations.load();
  int commands = 0;
  while (interpreter.next() != Progress::ended) ++commands;
  const std::size_t after = allocations.load();
  REQUIRE(commands > 1000);
  return after - before;
}

}  // namespace

TEST_CASE("Plain lines are interpreted without allocating", "[JOB-6]") {
  std::string text = "G21 G90\nF100\n";
  for (int i = 0; i < 2000; ++i) {
    text += "G1 X1.234 Y-2.5 Z" + std::to_string(i) + " F200\nX2\nG2 I1.5\nG0 Z5 M8 S100\n";
  }
  CHECK(allocations_of(text, 20) == 0);
}

TEST_CASE("Compensated lines are interpreted without allocating", "[JOB-6][GCO-4]") {
  std::string text = "F100\nG41.1 D2\nG1 X10\n";
  for (int i = 0; i < 1000; ++i) text += "Y10 M8\nX0\nY0\nX10\n";
  CHECK(allocations_of(text, 20) == 0);
}

TEST_CASE("Rounds of a loop are interpreted without allocating", "[JOB-6][LNG-3]") {
  const std::string text =
      "F100\nwhile [#1 < 2000]\n#2=[50*cos[#1]] #3=[sin[#1]*2]\nif [#1 > 5]\nG1 X#2 Y[#3+1]\nelse\n"
      "G1 X0\nendif\n#1=[#1+1]\nendwhile\n";
  CHECK(allocations_of(text, 20) == 0);
}
