#include "interpreter/parameter_access.h"

#include <cmath>
#include <fmt/format.h>

#include "interpreter/block.h"
#include "interpreter/parameter_table.h"

namespace cnc::interp {
namespace {

/// Program units to mm or degrees.
[[nodiscard]] double scale_of(const ParameterMeaning& meaning, std::int32_t number,
                              const MachineState& state) {
  switch (meaning.quantity) {
    case Quantity::length:
      return state.scale();
    case Quantity::position:
      return state.scale(kAllAxes.at(static_cast<std::size_t>(number - meaning.first)));
    case Quantity::plain:
    case Quantity::whole:
      break;
  }
  return 1.0;
}

}  // namespace

double ParameterAccess::get_system(std::int32_t number) const {
  const ParameterMeaning* meaning = meaning_of(number);
  if (meaning == nullptr) return store_.get(number);
  if (meaning->is_live && !live_is_fresh_) wants_live_ = true;
  const double value = meaning->read == nullptr ? store_.get(number)
                                                : meaning->read({state_, tools_, settings_.machine},
                                                                number - meaning->first);
  return value / scale_of(*meaning, number, state_);
}

void ParameterAccess::set(std::int32_t number, double value) {
  if (ParameterNames::is_name(number)) return names_.set(number, value);
  const ParameterMeaning* meaning = is_system(number) ? meaning_of(number) : nullptr;
  if (meaning == nullptr) return store_.set(number, value);
  const double stored = stored_value(*meaning, number, value);
  if (meaning->writing != Writing::tool_data) return store_.set(number, stored);
  const std::int32_t tool_number = number - meaning->first;
  static_cast<void>(tools_.set(tool_number, changed_tool(*meaning, tool_number, stored)));
}

/// As the store keeps it.
double ParameterAccess::stored_value(const ParameterMeaning& meaning, std::int32_t number,
                                     double value) const {
  if (meaning.quantity == Quantity::whole) return std::nearbyint(value);
  return value * scale_of(meaning, number, state_);
}

config::Tool ParameterAccess::changed_tool(const ParameterMeaning& meaning,
                                           std::int32_t tool_number, double stored) const {
  config::Tool tool = tools_.tool(tool_number);
  meaning.set_tool(tool, stored);
  return tool;
}

Accepted ParameterAccess::check_writable(std::int32_t number, Span span) {
  const ParameterMeaning* meaning = meaning_of(number);
  if (meaning == nullptr) return {};
  if (meaning->writing == Writing::never) {
    return refuse(ErrorCode::parameter_read_only, span,
                  fmt::format("#{} can only be read.", number), std::string(meaning->instead));
  }
  if (meaning->writing == Writing::tool_data && number == meaning->first) {
    return refuse(ErrorCode::parameter_read_only, span,
                  fmt::format("#{} belongs to tool 0, which is no tool.", number),
                  fmt::format("#{} to #{} for the tools 1 to {}.", number + 1, meaning->last,
                              config::kMaxTool));
  }
  return {};
}

Accepted ParameterAccess::check_system(const ParameterSetting& setting) const {
  const auto& [number, value, span] = setting;
  if (Accepted writable = check_writable(number, span); !writable) return writable;
  if (!(std::abs(value) <= kMaxWordValue)) {  // NaN too
    return refuse(ErrorCode::word_out_of_range, span,
                  fmt::format("#{} cannot be {:.6g}.", number, value),
                  fmt::format("Values up to {:.0e}.", kMaxWordValue));
  }
  const ParameterMeaning* meaning = meaning_of(number);
  if (meaning == nullptr || can_be(*meaning, number, value)) return {};
  return refuse(ErrorCode::parameter_value_refused, span,
                fmt::format("#{} cannot be {:.10g}.", number, value),
                std::string(meaning->instead));
}

bool ParameterAccess::can_be(const ParameterMeaning& meaning, std::int32_t number,
                             double value) const {
  const double stored = stored_value(meaning, number, value);
  if (meaning.quantity == Quantity::whole && !whole_number(value)) return false;
  if (meaning.writing == Writing::work_system) {
    return stored >= 1.0 && stored <= config::kWorkSystemCount;
  }
  if (meaning.writing != Writing::tool_data) return true;
  const std::int32_t tool_number = number - meaning.first;
  return config::ToolTable::check(tool_number, changed_tool(meaning, tool_number, stored))
      .has_value();
}

bool ParameterAccess::affects_offsets(std::int32_t number) {
  using namespace config::parameter;
  return number >= kActiveSystem &&
         number < kWorkOffset + kWorkSystemStride * (config::kWorkSystemCount - 1) +
                      static_cast<std::int32_t>(kAxisCount);
}

bool ParameterAccess::affects_tools(std::int32_t number) {
  const ParameterMeaning* meaning = meaning_of(number);
  return meaning != nullptr && meaning->writing == Writing::tool_data;
}

}  // namespace cnc::interp
