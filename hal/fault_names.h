// The names of a board's faults, as traces and their files have them.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "hal/controller.h"

namespace cnc::hal {

struct FaultName {
  Fault fault;
  std::string_view name;
};
inline constexpr std::array kFaultNames{
    FaultName{Fault::fifo_underrun, "fifo_underrun"}, FaultName{Fault::estop, "estop"},
    FaultName{Fault::bad_segment, "bad_segment"},     FaultName{Fault::link_lost, "link_lost"},
    FaultName{Fault::index_missing, "index_missing"}, FaultName{Fault::step_loss, "step_loss"},
    FaultName{Fault::guard_stop, "guard_stop"},
};

/// "estop, link_lost"; "none".
[[nodiscard]] inline std::string fault_names(Faults faults) {
  std::string text;
  for (const FaultName& row : kFaultNames) {
    if ((faults & static_cast<Faults>(row.fault)) == 0) continue;
    if (!text.empty()) text += ", ";
    text += row.name;
  }
  return text.empty() ? "none" : text;
}

}  // namespace cnc::hal
