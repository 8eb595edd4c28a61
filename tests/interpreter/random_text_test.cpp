// Whatever bytes a program holds, the interpreter answers with commands or a diagnostic.
#include <catch2/catch.hpp>
#include <random>

#include "tests/interpreter/support.h"

using namespace cnc;
using namespace cnc::interp;
using namespace cnc::interp::test;

namespace {

void run_bounded(const std::string& text) {
  const auto program = Program::from_text(text, "random");
  if (!program) return;
  CheckOptions options;
  options.max_loop_lines = 2'000;
  options.max_errors = 50;
  InterpreterSettings settings;
  settings.lines_per_call = 50;
  const CheckReport report = check(*program, settings, {}, {}, {}, options);
  for (const Diagnostic& error : report.errors) {
    CHECK_FALSE(error.to_string().empty());
    CHECK(error.line >= 1);
    CHECK(error.line <= report.line_count);
  }
}

}  // namespace

TEST_CASE("Random bytes are refused or executed, never worse", "[LNG-10]") {
  std::mt19937 random(20240601);
  std::uniform_int_distribution<int> byte(1, 255);
  for (int round = 0; round < 2000; ++round) {
    std::string text(1 + random() % 200, ' ');
    for (char& c : text) c = static_cast<char>(byte(random));
    run_bounded(text);
  }
}

TEST_CASE("Random pieces of the language are refused or executed, never worse", "[LNG-10]") {
  const std::vector<std::string> pieces{
      "G0",     "G1",     "G2",      "G53",  "G92",      "G38.2", "G76",   "G84",    "G87",
      "G96 S1", "M3",     "K1",      "J1",   "Q1",       "G10",   "X",     "Y1",     "Z-2",
      "I3",     "R4",     "F60",     "L2",   "L20",      "P1",    "#1",    "#",      "=",
      "[",      "]",      "sin",     "atan", "/",        "**",    "mod",   "<",      "==",
      "1",      "2.5",    ".",       "-",    "if",       "else",  "endif", "while",  "endwhile",
      "sub a",  "endsub", "gosub a", "msg",  "\"text\"", "(",     ")",     ";",      "(MSG,",
      "N10",    "O1",     "%",       "M30",  "M6",       "T1",    "M26",   "M54",    "M56",
      "M95",    "M90",    "M104",    "M190", "E1",       "S5",    "A1",    "#5401=", "#5220=",
      "#5390",  "\n",     "\n",      "\n",   " ",        "\t",    "\r\n"};
  std::mt19937 random(7);
  for (int round = 0; round < 5000; ++round) {
    std::string text;
    for (std::size_t count = 1 + random() % 60; count > 0; --count) {
      text += pieces[random() % pieces.size()];
    }
    run_bounded(text);
  }
}
