// Numbers with six decimals for text_of(): most of the time that printing a program takes goes
// there.
#pragma once

#include <string>

namespace cnc::interp {

/// Appends `value` with six decimals, correctly rounded; never "-0.000000", which would differ
/// between equal positions.
void append_six_decimals(std::string& text, double value);

}  // namespace cnc::interp
