// The words for enumerators, and an error as one line of text.
#include <array>
#include <string>
#include <string_view>

#include "api/error.h"
#include "api/message.h"
#include "api/status.h"

namespace cnc::api {
namespace {

using namespace std::string_view_literals;

constexpr std::array kErrorKinds{"refused"sv,      "invalid"sv,     "failed"sv,
                                 "unavailable"sv,  "timed_out"sv,   "cancelled"sv,
                                 "incompatible"sv, "unsupported"sv, "denied"sv};
constexpr std::array kStates{
    "unknown"sv,     "off"sv,      "needs_reset"sv, "needs_homing"sv, "ready"sv,   "jogging"sv,
    "homing"sv,      "mdi"sv,      "running"sv,     "pausing"sv,      "paused"sv,  "program_stop"sv,
    "tool_change"sv, "stopping"sv, "estop"sv,       "error"sv,        "question"sv};
constexpr std::array kCommands{
    "reset"sv,  "home"sv,           "jog"sv,  "mdi"sv,    "load"sv,           "run"sv,
    "pause"sv,  "resume"sv,         "stop"sv, "rewind"sv, "override_rates"sv, "set_work_zero"sv,
    "answer"sv, "accept_position"sv};
constexpr std::array kSpindleDirections{"off"sv, "clockwise"sv, "counterclockwise"sv};
constexpr std::array kTrusts{"trusted"sv, "doubtful"sv, "unknown"sv};
constexpr std::array kSeverities{"info"sv, "warning"sv, "error"sv};

static_assert(kErrorKinds.size() == static_cast<std::size_t>(ErrorKind::denied) + 1);
static_assert(kStates.size() == kMachineStateCount &&
              kMachineStateCount == static_cast<std::size_t>(MachineState::question) + 1);
static_assert(kCommands.size() == kCommandCount &&
              kCommandCount == static_cast<std::size_t>(Command::accept_position) + 1);
static_assert(kSpindleDirections.size() ==
              static_cast<std::size_t>(SpindleDirection::counterclockwise) + 1);
static_assert(kTrusts.size() == static_cast<std::size_t>(PositionTrust::unknown) + 1);
static_assert(kSeverities.size() == static_cast<std::size_t>(Severity::error) + 1);

template <std::size_t size, typename Enum>
std::string_view word(const std::array<std::string_view, size>& words, Enum value) {
  return words.at(static_cast<std::size_t>(value));
}

}  // namespace

std::string_view name_of(ErrorKind kind) { return word(kErrorKinds, kind); }
std::string_view name_of(MachineState state) { return word(kStates, state); }
std::string_view name_of(Command command) { return word(kCommands, command); }
std::string_view name_of(SpindleDirection direction) { return word(kSpindleDirections, direction); }
std::string_view name_of(PositionTrust trust) { return word(kTrusts, trust); }
std::string_view name_of(Severity severity) { return word(kSeverities, severity); }

std::string Error::to_string() const {
  std::string text;
  if (place) {
    text = place->file;
    if (place->line > 0) text += ':' + std::to_string(place->line);
    if (place->line > 0 && place->column > 0) text += ':' + std::to_string(place->column);
    if (!text.empty()) text += ": ";
  }
  text += message;
  if (code > 0) text += " [E" + std::to_string(code) + ']';
  return text;
}

}  // namespace cnc::api
