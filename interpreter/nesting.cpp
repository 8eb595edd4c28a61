#include "interpreter/nesting.h"

#include <algorithm>
#include <array>

#include "interpreter/expression_parser.h"
#include "interpreter/number_scan.h"

namespace cnc::interp {
namespace {

struct Row {
  std::string_view name;
  std::optional<double> NestingData::*value;
};
constexpr auto kRows = std::to_array<Row>({{"MX", &NestingData::material_x},
                                           {"MY", &NestingData::material_y},
                                           {"DX", &NestingData::pitch_x},
                                           {"DY", &NestingData::pitch_y},
                                           {"OX", &NestingData::offset_x},
                                           {"OY", &NestingData::offset_y}});

}  // namespace

void NestingData::read(std::string_view line) {
  TextCursor cursor(line);
  if (!cursor.take('%')) return;
  cursor.skip_blanks();
  const std::string_view name = cursor.letters();
  const auto row = std::ranges::find_if(
      kRows, [&](const Row& r) { return std::ranges::equal(name, r.name, {}, upper); });
  if (row == kRows.end()) return;
  cursor.advance(name.size());
  if (!cursor.take('=')) return;
  cursor.skip_blanks();
  const bool negative = cursor.take('-');
  cursor.skip_blanks();
  const ScannedNumber number = scan_number(cursor.position(), cursor.end());
  if (number.end == cursor.position()) return;
  this->*row->value = negative ? -number.value : number.value;
}

}  // namespace cnc::interp
