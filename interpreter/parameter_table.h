// What the numbered parameters from #5000 on mean (manual 3.1.1): one row for a number or a run of
// numbers says where the value comes from, in which unit, and what a program may write.
//
// Numbers without a row are memory like #1 to #4999.
#pragma once

#include <cstdint>
#include <string_view>

#include "config/tool_table.h"
#include "interpreter/interpreter_settings.h"
#include "interpreter/machine_state.h"

namespace cnc::interp {

/// What the values of parameters are read from, besides the store.
struct ParameterSources {
  const MachineState& state;
  const config::ToolTable& tools;
  const MachineFacts& machine;
};

enum class Quantity : std::uint8_t {
  plain,
  whole,     ///< nothing but whole numbers
  length,    ///< in the program's unit
  position,  ///< of the six axes: as the program writes their words
};

enum class Writing : std::uint8_t {
  allowed,
  never,        ///< only the machine writes it
  work_system,  ///< 1 … 9
  tool_data,    ///< goes to the tool table
};

struct ParameterMeaning {
  std::int32_t first;
  std::int32_t last;
  Quantity quantity;
  Writing writing;
  /// The value of number first + n, lengths in mm; without it the store's.
  double (*read)(const ParameterSources& from, std::int32_t n);
  /// What a program can do instead, or which values are allowed: a sentence for the machinist.
  std::string_view instead;
  void (*set_tool)(config::Tool& tool, double value) = nullptr;  ///< of tool data
  bool is_live = false;  ///< only the machine knows it: the program waits for it
};

/// Row of a number; nullptr if it has none.
[[nodiscard]] const ParameterMeaning* meaning_of(std::int32_t number);

}  // namespace cnc::interp
