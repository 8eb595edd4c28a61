#include "config/error.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace cnc {
namespace {

constexpr auto kTable = std::to_array<ErrorInfo>({
#define CNC_ERROR(number, name, sentence, check) {ErrorCode::name, #name, sentence, check},
#include "config/error_table.def"
#undef CNC_ERROR
});

static_assert(std::ranges::adjacent_find(kTable, std::ranges::greater_equal{}, &ErrorInfo::code) ==
                  kTable.end(),
              "error_table.def must be strictly ascending by number");

}  // namespace

std::span<const ErrorInfo> error_table() { return kTable; }

const ErrorInfo& error_info(ErrorCode code) {
  const auto row = std::ranges::lower_bound(kTable, code, {}, &ErrorInfo::code);
  return row != kTable.end() && row->code == code ? *row : kTable.front();
}

std::string errors_as_markdown() {
  std::string page =
      "# Errors\n\n"
      "This page is written from `config/error_table.def`; a test fails when the two differ. A "
      "message ends\n"
      "with its number in brackets, `[E1001]`; the API carries number and name in "
      "`cnc.v1.ErrorDetail`.\n\n"
      "| number | name | what happened | what to check |\n|---|---|---|---|\n";
  for (const ErrorInfo& row : kTable)
    page += fmt::format("| E{} | {} | {} | {} |\n", static_cast<unsigned>(row.code), row.name,
                        row.sentence, row.check);
  return page;
}

std::string Error::to_string() const {
  std::string text;
  if (place) {
    text = place->file;
    if (place->line != 0) text += fmt::format(":{}", place->line);
    if (place->line != 0 && place->column != 0) text += fmt::format(":{}", place->column);
    text += ": ";
  }
  return text + fmt::format("{} [E{}]", message, static_cast<unsigned>(code));
}

}  // namespace cnc
