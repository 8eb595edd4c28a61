// Parameters as a program sees them (manual 3.1.1): most are the store's, some are read from the
// interpreter's state at the moment they are asked for, and lengths are in the program's unit.
//
// The store keeps millimetres. A program in inches reads and writes its positions, offsets and tool
// data in inches, so that "G0 X[#5001 + 1]" and "G53 G0 X#5161" mean what they say under G20 too.
#pragma once

#include <cstdint>

#include "config/parameter_store.h"
#include "config/tool_table.h"
#include "interpreter/machine_state.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

class ParameterAccess {
 public:
  ParameterAccess(const config::ParameterStore& store, const config::ToolTable& tools,
                  const MachineState& state)
      : store_(store), tools_(tools), state_(state) {}

  /// `number` is valid.
  [[nodiscard]] double get(std::int32_t number) const {
    return number < kFirstSystem ? store_.get(number) : get_system(number);
  }
  /// A value that the program gives, as the store keeps it.
  [[nodiscard]] double to_store(std::int32_t number, double value) const;

  /// Refuses what only the machine writes.
  [[nodiscard]] static Accepted check_writable(std::int32_t number, Span span);
  /// Whether it has a meaning for the machine.
  [[nodiscard]] static constexpr bool is_system(std::int32_t number) {
    return number >= kFirstSystem;
  }
  /// Whether writing it changes the offsets in force.
  [[nodiscard]] static bool affects_offsets(std::int32_t number);

 private:
  static constexpr std::int32_t kFirstSystem = 5000;

  [[nodiscard]] double get_system(std::int32_t number) const;
  [[nodiscard]] double scale_of(std::int32_t number) const;

  const config::ParameterStore& store_;
  const config::ToolTable& tools_;
  const MachineState& state_;
};

}  // namespace cnc::interp
