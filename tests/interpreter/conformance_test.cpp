// The conformance tables are complete: every code and statement of the interpreter's tables is
// named by a row whose program runs, and by the dictionary of the fuzzer.
#include "tests/interpreter/conformance.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <set>

#include "interpreter/code_table.h"
#include "interpreter/statements.h"
#include "tests/interpreter/support.h"

using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// G or M and ten times the number.
using CodeName = std::pair<char, long>;

void add_codes(const std::string& program, std::set<CodeName>& codes) {
  for (std::size_t i = 0; i < program.size(); ++i) {
    const bool begins_word = i == 0 || !is_letter(program[i - 1]);
    if (!begins_word || (program[i] != 'g' && program[i] != 'm')) continue;
    const char* const digits = program.c_str() + i + 1;
    if (std::isdigit(static_cast<unsigned char>(*digits)) == 0) continue;
    codes.insert({program[i], std::lround(10 * std::strtod(digits, nullptr))});
  }
}

bool begins_a_line(const std::string& program, const std::string& statement) {
  for (std::size_t at = program.find(statement); at != std::string::npos;
       at = program.find(statement, at + 1)) {
    const std::size_t end = at + statement.size();
    const bool is_whole = end == program.size() || !is_letter(program[end]);
    if (is_whole && (at == 0 || program[at - 1] == '\n')) return true;
  }
  return false;
}

/// The programs of all rows, in small letters.
std::vector<std::string> programs() {
  std::vector<std::string> all;
  for (const auto rows :
       {g_code_move_rows(), g_code_command_rows(), m_code_rows(), statement_rows()}) {
    for (const Row& row : rows) all.push_back(lower(row.program));
  }
  return all;
}

}  // namespace

TEST_CASE("Every G and M code is named by a conformance row", "[conformance]") {
  std::set<CodeName> named;
  for (const std::string& program : programs()) add_codes(program, named);
  for (const Code& code : g_codes()) {
    INFO(code.name);
    CHECK(named.contains({'g', code.number}));
  }
  for (const Code& code : m_codes()) {
    INFO(code.name);
    CHECK(named.contains({'m', 10L * code.number}));
  }
}

TEST_CASE("Every statement is named by a conformance row", "[conformance]") {
  const std::vector<std::string> all = programs();
  for (const SpecialStatement& statement : special_statements()) {
    INFO(statement.name);
    CHECK(std::any_of(all.begin(), all.end(), [&](const std::string& program) {
      return begins_a_line(program, std::string(statement.name));
    }));
  }
}

TEST_CASE("The fuzzer's dictionary holds every code and statement", "[conformance]") {
  const std::string dictionary = read_file(CNC_SOURCE_DIR "/tests/fuzz/interpreter.dict");
  for (const std::span<const Code> table : {g_codes(), m_codes()}) {
    for (const Code& code : table) {
      INFO(code.name);
      CHECK(dictionary.find(fmt::format("\"{}\"", code.name)) != std::string::npos);
    }
  }
  for (const SpecialStatement& statement : special_statements()) {
    INFO(statement.name);
    CHECK(dictionary.find(fmt::format("\"{} ", statement.name)) != std::string::npos);
  }
}
