// M54 M55 M56, M80 M81, M84-M87, M26 M27: what a program switches and reads by itself (manual 3.5.8
// to 3.5.10).
#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "interpreter/execution.h"
#include "interpreter/handlers.h"
#include "interpreter/words.h"

namespace cnc::interp {
namespace {

/// First and last number of what the board numbers in one row.
struct PortRange {
  std::int32_t first;
  std::int32_t last;
};
constexpr PortRange kBoardPorts{1, 50};
/// Home switches X to C; probe, sync, hand wheel A and B, ESTOP1, ESTOP2, EXTERR.
constexpr auto kNamedInputs = std::to_array<PortRange>({{51, 56}, {61, 67}});
constexpr std::int32_t kPortsPerCard = 100;  // port 3 of card 1 is 103
constexpr std::int32_t kLastCard = 9;

enum class PortKind : std::uint8_t { output, input, analog_output, analog_input };
constexpr std::array<std::string_view, 4> kPortNames{"output", "input", "analog output",
                                                     "analog input"};

[[nodiscard]] bool is_in(PortRange range, std::int32_t number) {
  return number >= range.first && number <= range.last;
}

[[nodiscard]] bool is_port(PortKind kind, std::int32_t number) {
  const std::int32_t card = number / kPortsPerCard;
  if (card >= 1) return card <= kLastCard && number % kPortsPerCard != 0;
  if (is_in(kBoardPorts, number)) return true;
  return kind == PortKind::input &&
         std::ranges::any_of(kNamedInputs, [&](PortRange range) { return is_in(range, number); });
}

/// The word `letter` as a port. How many of them a board really has, the machine knows.
Parsed<std::int32_t> port_word(const Execution& x, char letter, PortKind kind) {
  const double value = x.block().value(letter);
  const auto number = whole_number(value);
  if (number && is_port(kind, *number)) return *number;
  const bool has_names = kind == PortKind::input;
  return refuse(
      ErrorCode::word_out_of_range, x.block().span_of(letter),
      fmt::format("{}{:.10g} is no {}.", letter, value,
                  kPortNames.at(static_cast<std::size_t>(kind))),
      fmt::format("{0}1 to {0}{1}{2}; {0}103 is port 3 of I/O card 1.", letter, kBoardPorts.last,
                  has_names ? ", P51 to P56 home switches, P61 to P67 probe, sync, hand "
                              "wheel, emergency stops and external error"
                            : ""));
}

/// P or E: one of them, and beside it only words of `companions`.
Accepted check_port_words(const Execution& x, std::string_view beside_p,
                          std::string_view beside_e) {
  const Block& block = x.block();
  if (Accepted one = check_not_both(x, 'P', 'E'); !one) return one;
  if (!block.has('P') && !block.has('E')) {
    return refuse(ErrorCode::word_missing, x.code_span(),
                  fmt::format("{} names no port.", x.code_name()),
                  "P and a digital port, or E and an analog port.");
  }
  const char port = block.has('P') ? 'P' : 'E';
  for (const char letter : std::string_view("LQ")) {
    const bool fits = (port == 'P' ? beside_p : beside_e).find(letter) != std::string_view::npos;
    if (fits || !block.has(letter)) continue;
    return refuse(ErrorCode::word_unused, block.span_of(letter),
                  fmt::format("{} with {} has no word {}.", x.code_name(), port, letter));
  }
  return {};
}

Accepted require(const Execution& x, char letter, std::string_view what) {
  if (x.block().has(letter)) return {};
  return refuse(ErrorCode::word_missing, x.code_span(),
                fmt::format("{} needs the word {}.", x.code_name(), letter),
                fmt::format("{} and {}.", letter, what));
}

Accepted set_analog_output(Execution& x) {
  constexpr double kPerMille = 1000.0;
  if (Accepted value = require(x, 'Q', "the value, 0 to 1000"); !value) return value;
  const auto port = port_word(x, 'E', PortKind::analog_output);
  if (!port) return std::unexpected(port.error());
  const auto value = word_within(x, 'Q', 0.0, kPerMille);
  if (!value) return std::unexpected(value.error());
  x.emit(SetAnalogOutput{*port, *value / kPerMille});
  return {};
}

Accepted set_digital_output(Execution& x, bool on) {
  const auto port = port_word(x, 'P', PortKind::output);
  if (!port) return std::unexpected(port.error());
  x.emit(SetOutput{*port, on});
  return {};
}

Accepted read_analog_input(Execution& x) {
  const auto port = port_word(x, 'E', PortKind::analog_input);
  if (!port) return std::unexpected(port.error());
  x.emit(ReadInput{.port = *port, .analog = true});
  return {};
}

Accepted read_digital_input(Execution& x) {
  constexpr double kLongestWait = 86'400.0;  // a day
  const Block& block = x.block();
  const auto port = port_word(x, 'P', PortKind::input);
  if (!port) return std::unexpected(port.error());
  if (!block.has('L') && !block.has('Q')) {
    x.emit(ReadInput{.port = *port});
    return {};
  }
  if (Accepted mode = require(x, 'L', "how to wait: 0 not at all, 1 for high, 2 for low"); !mode) {
    return mode;
  }
  const auto mode = whole_word(x, 'L', 0, 2);
  if (!mode) return std::unexpected(mode.error());
  const auto wait = WaitForInput{static_cast<std::uint8_t>(*mode)};
  if (wait == WaitForInput::no) {
    x.emit(ReadInput{.port = *port});
    return {};
  }
  // Without a time-out a switch that never comes would hold up the machine for good.
  if (Accepted timeout = require(x, 'Q', "how long to wait at most, seconds"); !timeout) {
    return timeout;
  }
  const auto timeout = word_within(x, 'Q', 0.0, kLongestWait);
  if (!timeout) return std::unexpected(timeout.error());
  x.emit(ReadInput{.port = *port, .wait = wait, .timeout = *timeout});
  return {};
}

}  // namespace

Accepted set_output(Execution& x) {
  if (Accepted words = check_port_words(x, "", "Q"); !words) return words;
  return x.block().has('P') ? set_digital_output(x, true) : set_analog_output(x);
}

Accepted clear_output(Execution& x) { return set_digital_output(x, false); }

Accepted read_input(Execution& x) {
  if (Accepted words = check_port_words(x, "LQ", ""); !words) return words;
  return x.block().has('P') ? read_digital_input(x) : read_analog_input(x);
}

Accepted switch_drives(Execution& x) {
  x.emit(EnableDrives{x.code() == 80});
  return {};
}

Accepted switch_spindle_output(Execution& x) {
  const std::int32_t code = x.code();
  const bool on = code == 84 || code == 86;
  const bool is_pwm = code == 86 || code == 87;
  ModalState& modal = x.state().modal;
  (is_pwm ? modal.spindle_pwm_output : modal.spindle_direction_output) = on;
  x.emit(SetSpindleOutput{is_pwm ? SpindleOutput::pwm : SpindleOutput::direction, on});
  return {};
}

namespace {

/// The brake that is closed is the one to open: otherwise the motor of A would turn against it.
Accepted check_same_brake(const Execution& x, std::int32_t port) {
  const ModalState& modal = x.state().modal;
  if (!modal.a_clamped || modal.clamp_port == port) return {};
  const std::string written = modal.clamp_port ? fmt::format("M26 P{}", *modal.clamp_port) : "M26";
  return refuse(ErrorCode::axis_clamped, x.block().span_of('P'),
                fmt::format("The A axis was clamped by {}: {} P{} is another brake.", written,
                            x.code_name(), port),
                "M27 without P opens the brake that is closed.");
}

}  // namespace

Accepted switch_clamp(Execution& x) {
  ModalState& modal = x.state().modal;
  const bool on = x.code() == 26;
  std::optional<std::int32_t> port = modal.clamp_port;  // of the brake that is closed
  if (x.block().has('P')) {
    const auto given = port_word(x, 'P', PortKind::output);
    if (!given) return std::unexpected(given.error());
    if (Accepted same = check_same_brake(x, *given); !same) return same;
    port = *given;
  }
  modal.a_clamped = on;
  modal.clamp_port = on ? port : std::nullopt;
  x.emit(ClampAxis{Axis::A, on, port});
  return {};
}

}  // namespace cnc::interp
