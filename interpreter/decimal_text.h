// Numbers with six decimals for text_of(): most of the time that printing a program takes goes
// there.
#pragma once

#include <span>
#include <string>

namespace cnc::interp {

/// Appends numbers with six decimals, correctly rounded, separated by ", "; never "-0.000000",
/// which would differ between equal positions.
void append_six_decimals(std::string& text, std::span<const double> numbers);

}  // namespace cnc::interp
