// Parameters as a program sees them (manual 3.1.1): most are the store's, some are read from the
// interpreter's state at the moment they are asked for, and lengths are in the program's unit.
//
// parameter_table.h says which number means what. The store keeps millimetres. A program in inches
// reads and writes its positions, offsets and tool data in inches, so that "G0 X[#5001 + 1]" and
// "G53 G0 X#5161" mean what they say under G20 too.
#pragma once

#include <cstdint>
#include <utility>

#include "config/parameter_store.h"
#include "config/tool_table.h"
#include "interpreter/block.h"
#include "interpreter/interpreter_settings.h"
#include "interpreter/machine_state.h"
#include "interpreter/parameter_names.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

struct ParameterMeaning;

class ParameterAccess {
 public:
  ParameterAccess(const InterpreterSettings& settings, config::ParameterStore& store,
                  config::ToolTable& tools, ParameterNames& names, const MachineState& state)
      : settings_(settings), store_(store), tools_(tools), names_(names), state_(state) {}

  /// `number` is valid.
  [[nodiscard]] double get(std::int32_t number) const {
    return number < kFirstSystem ? store_.get(number) : get_system(number);
  }
  [[nodiscard]] const ParameterNames& names() const { return names_; }
  /// Writes a value that the program gives; check() has allowed it.
  void set(std::int32_t number, double value);

  /// Whether a value was asked for that only the machine knows, since the last call: the program
  /// has to wait for it and ask again.
  [[nodiscard]] bool take_wants_live() { return std::exchange(wants_live_, false); }
  /// Whether live values are up to date, so that asking for them is answered.
  void set_live(bool fresh) { live_is_fresh_ = fresh; }

  /// Refuses what only the machine writes.
  [[nodiscard]] static Accepted check_writable(std::int32_t number, Span span);
  /// Refuses also values that the parameter cannot have.
  [[nodiscard]] Accepted check(const ParameterSetting& setting) const {
    return is_system(setting.number) ? check_system(setting) : Accepted{};
  }
  /// Whether it has a meaning for the machine.
  [[nodiscard]] static constexpr bool is_system(std::int32_t number) {
    return number >= kFirstSystem;
  }
  /// Whether writing it changes the offsets in force.
  [[nodiscard]] static bool affects_offsets(std::int32_t number);
  /// Whether it is a tool's length, diameter, X offset or orientation.
  [[nodiscard]] static bool affects_tools(std::int32_t number);

 private:
  static constexpr std::int32_t kFirstSystem = 5000;

  [[nodiscard]] double get_system(std::int32_t number) const;
  [[nodiscard]] Accepted check_system(const ParameterSetting& setting) const;

  [[nodiscard]] double stored_value(const ParameterMeaning& meaning, std::int32_t number,
                                    double value) const;
  [[nodiscard]] config::Tool changed_tool(const ParameterMeaning& meaning, std::int32_t tool_number,
                                          double stored) const;
  [[nodiscard]] bool can_be(const ParameterMeaning& meaning, std::int32_t number,
                            double value) const;

  const InterpreterSettings& settings_;
  config::ParameterStore& store_;
  config::ToolTable& tools_;
  ParameterNames& names_;
  const MachineState& state_;
  bool live_is_fresh_ = false;
  mutable bool wants_live_ = false;
};

}  // namespace cnc::interp
