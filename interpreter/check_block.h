// The rules that a line must satisfy as a whole before any of it is executed (manual 3.2.5, 3.3 and
// the "It is an error if" of every code that need no values).
#pragma once

#include "interpreter/block.h"
#include "interpreter/modal_state.h"
#include "interpreter/refusal.h"

namespace cnc::interp {

/// Checks `block` and completes it: axis words without a motion code get the motion in force, and a
/// motion code whose words another code takes gets none.
Accepted check_block(Block& block, const ModalState& modal);

}  // namespace cnc::interp
