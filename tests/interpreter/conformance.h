// The conformance tables: what the manuals say, one row per rule, and who counts them.
#pragma once

#include <span>

namespace cnc::interp::test {

/// A rule of a manual, with its section, and what a program does by it: its commands, its moves, or
/// "error@column".
struct Row {
  const char* rule;
  const char* program;
  const char* expected;
};

/// Rows whose programs run. Together they name every code and statement (conformance_test.cpp).
[[nodiscard]] std::span<const Row> g_code_move_rows();
[[nodiscard]] std::span<const Row> g_code_command_rows();
[[nodiscard]] std::span<const Row> m_code_rows();
[[nodiscard]] std::span<const Row> statement_rows();

}  // namespace cnc::interp::test
