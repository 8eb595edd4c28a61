// Random programs as text: what a failing test prints, and what can be pasted into a test to be
// driven again.
#pragma once

#include <string>

#include "tests/motion/random_program.h"

namespace cnc::motion::test {

/// G-code with relative moves (G91), and remarks for what is no G-code.
[[nodiscard]] std::string text_of(const RandomProgram& program);

/// The program that text_of() would print like this. Throws std::invalid_argument for what it does
/// not know.
[[nodiscard]] RandomProgram program_of(const std::string& text);

}  // namespace cnc::motion::test
