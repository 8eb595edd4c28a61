#include "interpreter/number_scan.h"

#include <cstddef>
#include <fast_float/fast_float.h>
#include <string>

namespace cnc::interp {

ScannedNumber scan_long_number(const char* begin, const char* end) {
  std::string digits;  // without the blanks
  bool has_point = false;
  bool has_digit = false;
  const char* used = begin;
  for (const char* p = begin; p != end; ++p) {
    if (is_blank(*p)) continue;
    if (!starts_number(*p) || (*p == '.' && has_point)) break;
    (*p == '.' ? has_point : has_digit) = true;
    digits += *p;
    used = p + 1;
  }
  if (!has_digit) return {0.0, begin};

  ScannedNumber number{0.0, used};
  fast_float::from_chars(digits.data(), digits.data() + digits.size(), number.value,
                         fast_float::chars_format::fixed);
  return number;
}

}  // namespace cnc::interp
