// A trace file that comes from anywhere: it is read or refused, and what is read is replayed, or
// not, in bounded time. Either the bytes are the file; or they are its records; or they say which
// fields of a good trace, recorded here, become something else.
#include <algorithm>

#include "config/ini_file.h"
#include "hal/sim/virtual_controller.h"
#include "hal/trace/replay.h"
#include "hal/trace/traced_controller.h"
#include "tests/fuzz/fuzz_bytes.h"

namespace {

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::trace;
using cnc::fuzz::Bytes;
using cnc::fuzz::require;

config::MachineConfig machine() {
  config::MachineConfig config;
  for (const Axis axis : kAllAxes) {
    config::AxisConfig& motor = config.axes[axis];
    motor.negative_limit = -100.0;
    motor.positive_limit = 300.0;
    motor.velocity = 75.0;
    motor.acceleration = 3000.0;
    motor.steps_per_unit = 200.0;
    motor.port = axis <= Axis::Z ? static_cast<std::int32_t>(index_of(axis)) + 1 : 0;
  }
  config.guards[0] = {"smooth", 1, 1, config::GuardAction::smooth_stop};
  config.guards[1] = {"quick", 2, 0, config::GuardAction::quick_stop};
  return config;
}

/// A move, a cut, outputs, latches, a guard rule and an estop, in 0.2 s.
std::vector<std::uint64_t> record(Ring& ring) {
  auto owned = sim::make_virtual_controller(
      machine(), {.machine = {.ports_on = std::uint64_t{1} << (kAuxCount + 1)}});
  sim::VirtualMachine& hands = owned->machine();
  TracedController controller(std::move(owned), ring);
  require(controller.connect().has_value());
  controller.set_outputs({.drives_enabled = true});
  for (int i = 0; i < 100; ++i) {
    if (i == 5) {
      std::array<Segment, 20> segments{};
      for (std::uint32_t k = 0; k < segments.size(); ++k) {
        segments[k] = {.id = k + 1, .duration = 0.01};
        segments[k].position[Axis::X] = 0.05 * std::min(k + 1.0, 10.0);
        segments[k].change.mist = k % 2 == 0;
      }
      controller.push(segments);
      controller.arm_home_latch(Axis::X, LatchEdge::activate);
    }
    if (i == 15) controller.cut_behind(12);
    if (i == 20) hands.set_port_input(kAuxCount, true);
    if (i == 50) controller.release_stop();
    if (i == 60) controller.set_position(Axis::Y, 5.0);
    if (i == 70) hands.press_estop(true);
    if (i == 80) hands.press_estop(false);
    if (i == 85) controller.clear_faults();
    controller.exchange(1.0 + 0.002 * i);
  }
  return ring.copy();
}

const About& about() {
  static const About kAbout{.reason = "fuzz",
                            .written = "now",
                            .server = "1.2.3",
                            .board = "virtual",
                            .config = config::machine_config_text(machine())};
  return kAbout;
}

const Trace& good_trace() {
  static const Trace kTrace = [] {
    Ring ring;
    auto trace = parse_trace(trace_bytes(about(), record(ring)), "good");
    require(trace.has_value());
    const auto report = replay(*trace);
    require(report && !report->difference);
    return std::move(*trace);
  }();
  return kTrace;
}

/// Gives one field another value.
class Spoiler : public FieldWalker<Spoiler> {
 public:
  explicit Spoiler(Bytes& bytes) : bytes_(bytes), left_(bytes.byte()) {}

  template <typename T>
  void leaf(std::string_view, T& value) {
    if (left_-- != 0) return;
    if constexpr (kIsBits<T>) {
      value = T(bytes_.next<std::uint64_t>());
    } else if constexpr (std::is_same_v<T, bool>) {
      value = !value;
    } else if constexpr (std::is_floating_point_v<T>) {
      value = bytes_.flag() ? bytes_.real() : value + 1e-3 * bytes_.next<std::int16_t>();
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(bytes_.below(2));
    } else {
      value = static_cast<T>(bytes_.flag() ? bytes_.next<T>() : value + 1);
    }
  }

 private:
  Bytes& bytes_;
  int left_;
};

Trace spoiled_trace(Bytes& bytes) {
  Trace trace = good_trace();
  if (bytes.flag()) trace.steps.erase(trace.steps.begin(), trace.steps.begin() + bytes.below(100));
  while (!bytes.empty()) {
    Step& step = trace.steps[bytes.byte() % trace.steps.size()];
    if (step.requests.empty() || bytes.below(3) != 0) {
      Spoiler spoiler(bytes);
      visit_fields(spoiler, step.exchange);
    } else {
      Request& request = step.requests[bytes.byte() % step.requests.size()];
      Spoiler spoiler(bytes);
      std::visit([&](auto& fields) { visit_fields(spoiler, fields); }, request);
    }
  }
  return trace;
}

std::string file_of(const Trace& trace) {
  Ring ring(std::size_t{1} << 16U);
  for (const Step& step : trace.steps) {
    for (const Request& request : step.requests)
      std::visit([&](const auto& fields) { ring.write(fields); }, request);
    ring.write(step.exchange);
  }
  return trace_bytes(about(), ring.copy(), 1e300);
}

std::string file_from(Bytes& bytes) {
  std::vector<std::uint64_t> words;
  switch (bytes.below(4)) {
    case 0: {
      std::string file;
      while (!bytes.empty()) file += static_cast<char>(bytes.byte());
      return file;
    }
    case 1:
      while (!bytes.empty()) words.push_back(bytes.next<std::uint64_t>());
      return trace_bytes(about(), words, 1e300);
    default:
      return file_of(spoiled_trace(bytes));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const auto trace = parse_trace(file_from(bytes), "fuzz");
  if (!trace) {
    require(!trace.error().message.empty());
    return 0;
  }
  const auto report = replay(*trace);
  require(!report || report->compared <= trace->steps.size());
  return 0;
}
