// What is known of the machine from the moment it is connected.
#pragma once

#include "api/machine.h"

namespace cnc::gui {

struct MachineFacts {
  api::Machine machine;
  api::ServerVersion version;
};

}  // namespace cnc::gui
