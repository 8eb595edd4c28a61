// M48-M53: overrides and the inputs that act on the feed (manual 3.5.5).
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"
#include "interpreter/words.h"

namespace cnc::interp {

Accepted switch_overrides(Execution& x) {
  const bool enabled = x.code() == 48;
  x.state().modal.feed_override_enabled = enabled;
  x.state().modal.speed_override_enabled = enabled;
  x.emit(EnableOverrides{enabled, enabled});
  return {};
}

// A value switches the override on again: it could not act otherwise.
Accepted set_override(Execution& x) {
  constexpr double kHighestPercent = 300.0;
  const bool is_feed = x.code() == 50;
  ModalState& modal = x.state().modal;
  bool& enabled = is_feed ? modal.feed_override_enabled : modal.speed_override_enabled;
  SetOverride command{.which = is_feed ? Override::feed : Override::speed, .factor = {}};
  enabled = x.block().value('P') >= 0.0;
  if (enabled) {
    const auto percent = word_within(x, 'P', 0.0, kHighestPercent);
    if (!percent) return std::unexpected(percent.error());
    command.factor = *percent / 100.0;
  }
  x.emit(command);
  return {};
}

Accepted switch_override_input(Execution& x) {
  const auto on = switch_word(x, 'P', true);
  if (!on) return std::unexpected(on.error());
  x.emit(UseOverrideInput{*on});
  return {};
}

Accepted switch_hold_input(Execution& x) {
  const auto on = switch_word(x, 'P', true);
  if (!on) return std::unexpected(on.error());
  x.emit(UseHoldInput{*on});
  return {};
}

}  // namespace cnc::interp
