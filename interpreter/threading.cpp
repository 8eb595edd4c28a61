// G76: a thread on a lathe, in as many passes as it needs (manual 3.4.19). The geometry and where
// the formulae come from: docs/threading.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "interpreter/arc_geometry.h"
#include "interpreter/handlers.h"
#include "interpreter/moves.h"
#include "interpreter/spindle_moves.h"

namespace cnc::interp {
namespace {

/// A line is executed as a whole, so its passes are bounded.
constexpr double kMaxPasses = 1000.0;

/// What a word of G76 may be.
struct WordRule {
  char letter;
  double lowest;
  double highest;
  bool lowest_allowed;
  bool whole;
  std::string_view allowed;
};

constexpr auto kWords = std::to_array<WordRule>({
    {'P', 0.0, kMaxWordValue, false, false, "P, the pitch, above 0."},
    {'I', 0.0, kMaxWordValue, false, false, "I, the X of the thread's peak, above 0."},
    {'J', 0.0, kMaxWordValue, false, false, "J, the first cut, above 0."},
    {'K', 0.0, kMaxWordValue, false, false, "K, the depth of the thread, above 0."},
    {'R', 1.0, kMaxWordValue, true, false, "R of 1 (equal cuts) or more."},
    {'Q', 0.0, 80.0, true, false, "Q, the slide angle, from 0 to 80 degrees."},
    {'H', 0.0, kMaxPasses, true, true, "H, the spring passes: 0, 1, 2 …"},
    {'E', 0.0, kMaxWordValue, true, false, "E, the length of a taper, of 0 or more."},
    {'L', 0.0, 3.0, true, true, "L0 no taper, L1 entry, L2 exit, L3 both."},
});

/// Work coordinates, mm.
struct Thread {
  double drive_x;  ///< the drive line: X of it, and where it begins and ends
  double begin_z;
  double end_z;
  double peak_x;
  double inward;  ///< -1 for an external thread, +1 for an internal one: where deeper is along X
  double pitch;
  double first_cut;
  double depth;
  double degression;
  double slide;  ///< way along Z per way inwards
  std::int32_t spring_passes;
  double taper;
  bool entry_taper;
  bool exit_taper;

  [[nodiscard]] double length() const { return std::abs(end_z - begin_z); }
  /// +1 or -1: the direction of the cut along Z.
  [[nodiscard]] double forward() const { return end_z < begin_z ? -1.0 : 1.0; }
};

Accepted check_modes(const Execution& x) {
  if (x.state().modal.plane != Plane::xz) {
    return refuse(ErrorCode::threading_plane, x.code_span(), "G76 works in the XZ plane only.",
                  "G18 before it.");
  }
  if (!x.state().coordinates.transform().is_identity()) {
    return refuse(ErrorCode::threading_transformed, x.code_span(),
                  "G76 cannot be turned or scaled: G68 or G51 is active.",
                  "G69 and G50 before it.");
  }
  return check_spindle_leads(x);
}

Accepted check_axis_words(const Execution& x) {
  for (const Axis axis : kAllAxes) {
    if (axis == Axis::Z || !x.block().has(axis)) continue;
    const char letter = axis_name(axis)[0];
    return refuse(ErrorCode::word_unused, x.block().span_of(letter),
                  fmt::format("G76 has no word {}.", letter), "Z, where the drive line ends.");
  }
  if (x.block().has('Z')) return {};
  return refuse(ErrorCode::word_missing, x.code_span(), "G76 needs the word Z.",
                "Z, where the drive line ends.");
}

[[nodiscard]] bool fits(const WordRule& rule, double value) {
  const bool low_enough = rule.lowest_allowed ? value >= rule.lowest : value > rule.lowest;
  return low_enough && value <= rule.highest && (!rule.whole || whole_number(value).has_value());
}

Accepted check_words(const Execution& x) {
  for (const WordRule& rule : kWords) {
    const auto value = x.block().find(rule.letter);
    if (!value || fits(rule, *value)) continue;
    return refuse(ErrorCode::word_out_of_range, x.block().span_of(rule.letter),
                  fmt::format("{} of G76 cannot be {:.10g}.", rule.letter, *value),
                  std::string(rule.allowed));
  }
  if (x.block().find('L').value_or(0.0) == 0.0 || x.block().has('E')) return {};
  return refuse(ErrorCode::word_missing, x.code_span(), "G76 with a taper (L) needs the word E.",
                "E, the length of the taper.");
}

// I, J and K are measured as X words are: the manual's example calls X15 and X14 diameters.
[[nodiscard]] Thread thread_of(const Execution& x) {
  const Block& block = x.block();
  const MachineState& state = x.state();
  const Position start = state.work_position();
  const double x_scale = state.scale(Axis::X);
  const double z_scale = state.scale(Axis::Z);
  const double slide_angle = block.find('Q').value_or(0.0) * std::numbers::pi / 180.0;
  const std::int32_t tapers = whole_number(block.find('L').value_or(0.0)).value_or(0);
  const double peak = block.value('I') * x_scale;
  return {.drive_x = start[Axis::X],
          .begin_z = start[Axis::Z],
          .end_z = state.coordinates.to_work(target(x))[Axis::Z],
          .peak_x = peak,
          .inward = start[Axis::X] > peak ? -1.0 : 1.0,
          .pitch = block.value('P') * z_scale,
          .first_cut = block.value('J') * x_scale,
          .depth = block.value('K') * x_scale,
          .degression = block.find('R').value_or(1.0),
          .slide = std::tan(slide_angle),
          .spring_passes = whole_number(block.find('H').value_or(0.0)).value_or(0),
          .taper = block.find('E').value_or(0.0) * z_scale,
          .entry_taper = (tapers & 1) != 0,
          .exit_taper = (tapers & 2) != 0};
}

Accepted check_start(const Execution& x, const Thread& thread) {
  if (thread.drive_x < 0.0 || std::abs(thread.drive_x - thread.peak_x) < kSamePoint) {
    return refuse(ErrorCode::threading_start, x.code_span(),
                  "G76 begins on the thread's peak or behind the turning axis.",
                  "X above I for an external thread, from 0 to below I for an internal one.");
  }
  if (thread.peak_x + thread.inward * thread.depth >= 0.0) return {};
  return refuse(ErrorCode::word_out_of_range, x.block().span_of('K'),
                "This thread would be deeper than the turning axis.", "K up to I.");
}

Accepted check_length(const Execution& x, const Thread& thread) {
  const double half = thread.length() / 2.0;
  if (thread.taper > half + kSamePoint) {
    return refuse(ErrorCode::threading_too_short, x.block().span_of('E'),
                  "The taper of G76 is longer than half the drive line.",
                  fmt::format("E up to {:.10g} mm.", half));
  }
  const int tapers = int{thread.entry_taper} + int{thread.exit_taper};
  const double straight = thread.length() - thread.depth * thread.slide - tapers * thread.taper;
  if (straight > -kSamePoint && thread.length() > kSamePoint) return {};
  return refuse(ErrorCode::threading_too_short, x.block().span_of('Z'),
                "Between tapers and slide nothing of the drive line is left.",
                "A longer way to Z, a smaller E or Q.");
}

Accepted check_passes(const Execution& x, const Thread& thread) {
  const double cuts = std::pow(thread.depth / thread.first_cut, thread.degression);
  if (cuts + thread.spring_passes <= kMaxPasses) return {};
  return refuse(ErrorCode::word_out_of_range, x.block().span_of('J'),
                fmt::format("G76 would take {:.0f} passes.", cuts + thread.spring_passes),
                fmt::format("At most {:.0f}: a larger J, a smaller R or H.", kMaxPasses));
}

/// The moves. The tool goes in and out along X only and back along the drive line.
class ThreadPasses {
 public:
  ThreadPasses(Execution& x, const Thread& thread)
      : x_(x), thread_(thread), at_(x.state().work_position()) {}

  void run() {
    for (double pass = 1.0;; pass += 1.0) {
      const double depth = thread_.first_cut * std::pow(pass, 1.0 / thread_.degression);
      if (depth > thread_.depth - kSamePoint) break;
      cut(depth);
    }
    for (std::int32_t i = 0; i <= thread_.spring_passes; ++i) cut(thread_.depth);
    rapid_to(thread_.drive_x, thread_.begin_z);
  }

 private:
  void cut(double depth) {
    const double forward = thread_.forward();
    const double begin = thread_.begin_z + forward * depth * thread_.slide;
    const double end = thread_.end_z - forward * (thread_.depth - depth) * thread_.slide;
    const double bottom = thread_.peak_x + thread_.inward * depth;
    rapid_to(thread_.drive_x, begin);
    if (thread_.entry_taper) {
      rapid_to(taper_top(bottom), begin);
      taper_to(bottom, begin + forward * thread_.taper);
    } else {
      rapid_to(bottom, begin);
    }
    if (thread_.exit_taper) {
      thread_to(bottom, end - forward * thread_.taper, thread_.pitch);
      taper_to(taper_top(bottom), end);
    } else {
      thread_to(bottom, end, thread_.pitch);
    }
    rapid_to(thread_.drive_x, end);
  }

  /// A taper is as high as the thread is deep, but does not pass the drive line.
  [[nodiscard]] double taper_top(double bottom) const {
    const double height = std::min(thread_.depth, std::abs(bottom - thread_.drive_x));
    return bottom - thread_.inward * height;
  }

  /// Along Z at the thread's pitch; the way on the slope is longer.
  void taper_to(double x, double z) {
    const double along = std::abs(z - at_[Axis::Z]);
    if (along < kSamePoint) return rapid_to(x, z);
    const double way = std::hypot(x - at_[Axis::X], along);
    thread_to(x, z, thread_.pitch * way / along);
  }

  void rapid_to(double x, double z) {
    if (reach(x, z)) move_rapid(x_, machine_position());
  }
  void thread_to(double x, double z, double pitch) {
    if (reach(x, z)) move_with_spindle(x_, machine_position(), pitch);
  }
  /// False when the tool is there already.
  bool reach(double x, double z) {
    const Position before = at_;
    at_[Axis::X] = x;
    at_[Axis::Z] = z;
    return linear_length(at_ - before) >= kSamePoint;
  }
  [[nodiscard]] Position machine_position() const { return x_.state().coordinates.to_machine(at_); }

  Execution& x_;
  const Thread& thread_;
  Position at_;  ///< work coordinates
};

}  // namespace

Accepted threading_cycle(Execution& x) {
  if (Accepted modes = check_modes(x); !modes) return modes;
  if (Accepted axes = check_axis_words(x); !axes) return axes;
  if (Accepted words = check_words(x); !words) return words;
  const Thread thread = thread_of(x);
  if (Accepted start = check_start(x, thread); !start) return start;
  if (Accepted length = check_length(x, thread); !length) return length;
  if (Accepted few = check_passes(x, thread); !few) return few;
  in_exact_path(x, [&] { ThreadPasses(x, thread).run(); });
  x.state().modal.motion = x.code();
  return {};
}

}  // namespace cnc::interp
