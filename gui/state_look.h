// How each machine state looks: a word, a shape, a colour, and the key to be pressed next.
#pragma once

#include <optional>

#include "api/status.h"

namespace cnc::gui {

struct StateLook {
  api::MachineState state;
  const char* word;
  const char* shape;  ///< one character, UTF-8
  const char* tone;   ///< "grey", "yellow", "green", "blue", "red": a property value of style.qss
  std::optional<api::Command> next;  ///< the key that gets a blue edge
};

[[nodiscard]] const StateLook& look_of(api::MachineState state);

}  // namespace cnc::gui
