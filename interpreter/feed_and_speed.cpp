// F and S and what their numbers mean: G93 G94 G95 and G96 G97 (manual 3.4.24, 3.4.25).
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"

namespace cnc::interp {
namespace {

constexpr double kSecondsPerMinute = 60.0;

Accepted check_not_negative(const Execution& x, char letter, std::string_view what) {
  if (x.block().value(letter) >= 0.0) return {};
  return refuse(ErrorCode::word_out_of_range, x.block().span_of(letter),
                fmt::format("{} cannot be negative.", what),
                fmt::format("{} of 0 or more.", letter));
}

/// The unit of lengths on this line, which table 3-7 sets after F and S: "G21 F600" on a machine
/// that stands in inches must not become 600 inches per minute.
[[nodiscard]] LengthUnit line_unit(const Execution& x) {
  if (!x.block().has(Step::units)) return x.state().modal.unit;
  return unit_of(x.block().code(Step::units).number);
}

/// What F counts, per second or per revolution.
[[nodiscard]] double feed_word_value(const Execution& x) {
  const double value = x.block().value('F');
  const bool per_revolution = x.state().modal.feed_mode == FeedMode::per_revolution;
  return per_revolution ? value : value / kSecondsPerMinute;
}

/// S of G96 in mm/s.
[[nodiscard]] double surface_speed_of(const Execution& x) {
  return x.block().value('S') * surface_speed_unit(line_unit(x));
}

Accepted use_speed_limit(Execution& x) {
  const auto limit = x.block().find('D');
  if (!limit) return {};
  if (*limit <= 0.0) {
    return refuse(ErrorCode::word_out_of_range, x.block().span_of('D'),
                  fmt::format("The spindle cannot be limited to {:.10g} rpm.", *limit),
                  "D above 0.");
  }
  x.state().modal.max_speed = *limit;
  return {};
}

void emit_surface_speed(Execution& x) {
  const ModalState& modal = x.state().modal;
  x.emit(UseSurfaceSpeed{modal.surface_speed, modal.max_speed});
}

}  // namespace

// The number behind F means something else in the other mode, so it does not survive the change.
Accepted set_feed_mode(Execution& x) {
  ModalState& modal = x.state().modal;
  const FeedMode mode = x.code() == 930   ? FeedMode::inverse_time
                        : x.code() == 940 ? FeedMode::per_minute
                                          : FeedMode::per_revolution;
  if (mode == modal.feed_mode) return {};
  modal.feed_mode = mode;
  modal.feed = 0.0;
  modal.linear_feed = 0.0;
  modal.rotary_feed = 0.0;
  return {};
}

Accepted set_feed(Execution& x) {
  if (Accepted positive = check_not_negative(x, 'F', "The feed rate"); !positive) return positive;
  ModalState& modal = x.state().modal;
  const double feed = feed_word_value(x);
  if (modal.feed_mode == FeedMode::inverse_time) {
    modal.feed = feed;
  } else {
    modal.linear_feed = feed * millimetres_per(line_unit(x));
    modal.rotary_feed = feed;
    modal.feed = modal.linear_feed;
  }
  x.emit(SetFeedRate{modal.feed_mode, modal.feed});
  return {};
}

// S changes its meaning with the mode: 150 m/min is not 150 rpm. So it is written again. S itself
// is carried out after this (set_speed).
Accepted set_spindle_mode(Execution& x) {
  constexpr std::int32_t kG96 = 960;
  ModalState& modal = x.state().modal;
  const bool by_surface = x.code() == kG96;
  if (by_surface != modal.speed_by_surface && !x.block().has('S')) {
    return refuse(ErrorCode::word_missing, x.code_span(),
                  fmt::format("{} needs the word S: it counted {} so far.", x.code_name(),
                              by_surface ? "rpm" : "surface speed"),
                  by_surface ? "S in m/min, in feet/min under G20." : "S in rpm.");
  }
  modal.speed_by_surface = by_surface;
  if (Accepted limited = use_speed_limit(x); !limited) return limited;
  if (x.block().has('D') && !x.block().has('S')) emit_surface_speed(x);
  return {};
}

Accepted set_speed(Execution& x) {
  if (Accepted positive = check_not_negative(x, 'S', "The spindle speed"); !positive) {
    return positive;
  }
  ModalState& modal = x.state().modal;
  if (modal.speed_by_surface) {
    modal.surface_speed = surface_speed_of(x);
    emit_surface_speed(x);
  } else {
    modal.speed = x.block().value('S');
    x.emit(SetSpindleSpeed{modal.speed});
  }
  return {};
}

}  // namespace cnc::interp
