// The trace of the link: what is recorded, as a file, and read again; and files that are none.
#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <thread>

#include "config/ini_file.h"
#include "hal/cpu5/wire/crc32.h"
#include "hal/trace/replay.h"
#include "hal/trace/ring.h"
#include "hal/trace/trace_check.h"
#include "hal/trace/trace_file.h"
#include "hal/trace/traced_controller.h"
#include "tests/allocations.h"
#include "tests/hal/machine_support.h"

namespace cnc::hal::trace {
namespace {

using Catch::Contains;

/// Another value in every field.
struct Filler : FieldWalker<Filler> {
  template <typename T>
  void leaf(std::string_view, T& value) {
    ++count;
    if constexpr (kIsBits<T>) {
      value = T(count);
    } else if constexpr (std::is_same_v<T, bool>) {
      value = count % 2 == 0;
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(1);
    } else {
      value = static_cast<T>(count % 100);
    }
  }
  unsigned count = 0;
};

template <typename T>
T filled() {
  T record{};
  Filler filler;
  visit_fields(filler, record);
  return record;
}

template <typename T>
std::string text_of(const T& record) {
  std::string text;
  FieldText lines([&](const std::string& name, const auto& value) {
    if constexpr (kIsBits<std::remove_cvref_t<decltype(value)>>)
      text += name + " " + value.to_string() + "\n";
    else
      text += name + " " + std::to_string(static_cast<double>(value)) + "\n";
  });
  visit_fields(lines, record);
  return text;
}

Exchange exchange_at(double now) {
  Exchange exchange;
  exchange.now = now;
  return exchange;
}

std::string bytes_of(const Ring& ring, double seconds = 30.0) {
  return trace_bytes({.reason = "estop", .written = "now", .server = "1.2.3", .board = "a board"},
                     ring.copy(), seconds);
}

Trace trace_of(const Ring& ring, double seconds = 30.0) {
  auto trace = parse_trace(bytes_of(ring, seconds), "the ring");
  REQUIRE(trace);
  return std::move(*trace);
}

/// A small sound file: two segments, an exchange.
std::string sound_file() {
  Ring ring(1024);
  ring.write(Segment{.id = 1, .duration = 0.005});
  ring.write(Segment{.id = 2, .duration = 0.005});
  ring.write(exchange_at(1.0));
  return bytes_of(ring);
}

TEST_CASE("Every field of every record comes back as it was", "[hal][trace][LNK-4]") {
  Ring ring(1024);
  ring.note(7, 1234);
  ring.write(filled<Segment>());
  ring.write(filled<CutBehind>());
  ring.write(filled<SetOutputs>());
  ring.write(QuickStop{});
  ring.write(StopAlongPath{});
  ring.write(ReleaseStop{});
  ring.write(ClearFaults{});
  ring.write(filled<SetPosition>());
  ring.write(filled<ArmHomeLatch>());
  ring.write(filled<DisarmHomeLatch>());
  ring.write(ArmProbeLatch{});
  ring.write(DisarmProbeLatch{});
  ring.write(filled<ChangeOutputs>());
  ring.write(filled<Exchange>());
  const Trace trace = trace_of(ring);
  REQUIRE(trace.steps.size() == 1);
  const Step& step = trace.steps[0];
  REQUIRE(step.requests.size() == std::variant_size_v<Request>);
  for (std::size_t i = 0; i < step.requests.size(); ++i) {
    CHECK(step.requests[i].index() == i);
    std::visit(
        [](const auto& read) {
          CHECK(text_of(read) == text_of(filled<std::remove_cvref_t<decltype(read)>>()));
        },
        step.requests[i]);
  }
  CHECK(text_of(step.exchange) == text_of(filled<Exchange>()));
}

TEST_CASE("A ring keeps the newest whole records, however often it has gone round",
          "[hal][trace]") {
  Ring ring(1024);
  CHECK(ring.copy().empty());
  // 20 words a segment, 90 an exchange: three of these groups fit.
  std::uint32_t id = 0;
  for (int i = 1; i <= 1000; ++i) {
    for (int k = 0; k < 10; ++k) ring.write(Segment{.id = ++id, .duration = 0.001});
    ring.write(exchange_at(0.002 * i));
    const auto words = ring.copy();
    REQUIRE(words.size() <= 1024);
    REQUIRE(words.size() > (i > 10 ? 1024U - 90U : 0U));  // no more room than a record is wasted
  }
  const Trace trace = trace_of(ring);
  REQUIRE(trace.steps.size() >= 3);
  CHECK(trace.steps.back().exchange.now == Approx(2.0));
  for (auto step = trace.steps.rbegin(); step + 1 != trace.steps.rend(); ++step) {
    REQUIRE(step->requests.size() == 10);
    for (auto request = step->requests.rbegin(); request != step->requests.rend(); ++request)
      CHECK(std::get<Segment>(*request).id == id--);
  }
}

TEST_CASE("A ring of the usual size holds 30 s of 500 exchanges and 1500 segments a second",
          "[hal][trace]") {
  Ring ring;
  std::uint32_t id = 0;
  for (int i = 0; i <= 40 * 500; ++i) {
    for (int k = 0; k < 3; ++k) ring.write(Segment{.id = ++id, .duration = 0.001});
    ring.write(exchange_at(0.002 * i));
  }
  const Trace trace = trace_of(ring);
  CHECK(trace.steps.front().exchange.now == Approx(10.0).margin(0.0021));
  CHECK(trace.steps.back().exchange.now == Approx(40.0));
  CHECK(trace.steps.size() == 15'001);
}

TEST_CASE("A ring is copied while another thread writes to it", "[hal][trace][threads]") {
  Ring ring(1024);
  std::atomic<bool> ending{false};
  std::thread writer([&] {
    for (std::uint32_t id = 1; !ending; ++id) ring.write(Segment{.id = id, .duration = 1.0 * id});
  });
  std::size_t copied = 0;
  while (copied < 20'000) {
    const auto words = ring.copy();
    std::uint32_t before = 0;
    for (auto rest = std::span(words); !rest.empty();) {
      const RecordHead head = RecordHead::from(rest.front());
      REQUIRE(head.kind == kKindOf<Segment>);
      Segment segment;
      Decoder decoder(std::as_bytes(rest.subspan(1)).first(head.bytes));
      visit_fields(decoder, segment);
      REQUIRE(!decoder.bad());
      REQUIRE((before == 0 || segment.id == before + 1));
      REQUIRE(segment.duration == 1.0 * segment.id);
      before = segment.id;
      rest = rest.subspan(head.words());
      ++copied;
    }
  }
  ending = true;
  writer.join();
}

TEST_CASE("A traced controller does what the controller does, and allocates nothing",
          "[hal][trace]") {
  Ring ring;
  auto owned =
      sim::make_virtual_controller(sim::small_machine(), {.machine = {.start = Position{}}});
  TracedController controller(std::move(owned), ring);
  REQUIRE(controller.connect());
  const std::size_t before = test::allocations();
  controller.set_outputs({.drives_enabled = true});
  std::array<Segment, 3> segments{};
  for (std::uint32_t i = 0; i < 3; ++i) segments[i] = {.id = i + 1, .duration = 0.05};
  segments[2].position[Axis::X] = 1.0;
  controller.arm_home_latch(Axis::Y, LatchEdge::release);
  CHECK(controller.push(segments) == 3);
  controller.exchange(0.0);
  CHECK_FALSE(controller.set_position(Axis::X, 5.0));  // segments are on their way: not recorded
  for (int i = 1; i <= 100; ++i) controller.exchange(0.002 * i);
  CHECK(controller.set_position(Axis::Z, 5.0));
  controller.exchange(0.202);
  CHECK(test::allocations() == before);

  const Trace trace = trace_of(ring);
  REQUIRE(trace.steps.size() == 102);
  CHECK(trace.steps[0].requests.size() == 5);
  CHECK(std::get<Segment>(trace.steps[0].requests[4]).position[Axis::X] == 1.0);
  CHECK(trace.steps[1].requests.empty());
  CHECK(std::get<SetPosition>(trace.steps[101].requests[0]).position == 5.0);
  CHECK(trace.steps[101].exchange.status.position[Axis::X] == Approx(1.0));
  CHECK(trace.steps[101].exchange.status.executing_id == 3);
}

TEST_CASE("A trace that is cut short, damaged or none is refused", "[hal][trace]") {
  const std::string good = sound_file();
  REQUIRE(parse_trace(good, "good.trace"));
  const auto refused = [](const std::string& bytes) {
    const auto trace = parse_trace(bytes, "bad.trace");
    REQUIRE_FALSE(trace);
    CHECK_THAT(trace.error().message, Contains("bad.trace"));
    return trace.error();
  };
  for (std::size_t size = 0; size < good.size(); ++size) {
    CAPTURE(size);
    const Error error = refused(good.substr(0, size));
    CHECK(error.code == (size < 8 ? ErrorCode::not_a_trace : ErrorCode::trace_damaged));
    if (size >= 8) CHECK_THAT(error.message, Contains("ends in the middle"));
  }
  for (std::size_t place = 0; place < good.size(); ++place) {
    CAPTURE(place);
    std::string bad = good;
    bad[place] = static_cast<char>(bad[place] ^ 0x10);
    CHECK(refused(bad).code == (place < 8 ? ErrorCode::not_a_trace : ErrorCode::trace_damaged));
  }
}

TEST_CASE("Records that are none are refused though their check sum is right", "[hal][trace]") {
  struct Row {
    const char* rule;
    std::vector<std::uint64_t> words;
  };
  Ring ring(1024);
  ring.write(exchange_at(1.0));
  std::vector<std::uint64_t> short_exchange = ring.copy();
  short_exchange.pop_back();
  std::vector<std::uint64_t> mad_state = ring.copy();
  std::ranges::fill(std::span(mad_state).subspan(1), ~std::uint64_t{0});
  for (const Row& row : {Row{"no record at all", {}},
                         {"a kind that does not exist", {RecordHead{99, 0}.word()}},
                         {"a segment without its fields", {RecordHead{1, 0}.word()}},
                         {"an absurd size", {RecordHead{0, 0xFFFFFFFF}.word()}},
                         {"one word too few", short_exchange},
                         {"a truth that is neither 0 nor 1", mad_state}}) {
    CAPTURE(row.rule);
    const auto trace = parse_trace(trace_bytes({}, row.words), "bad.trace");
    REQUIRE_FALSE(trace);
    CHECK(trace.error().code == ErrorCode::trace_damaged);
  }
}

TEST_CASE("A number that no server writes is refused, and named", "[hal][trace]") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  struct Row {
    const char* rule;
    void (*spoil)(About&, std::vector<Request>&, std::vector<Exchange>&);
    const char* says;
  };
  const Row rows[] = {
      {"a position that is no number",
       [](About&, auto&, auto& exchanges) { exchanges[1].status.position[Axis::Y] = kNan; },
       "in exchange 1, a status.position.Y that is not a finite number"},
      {"a board time without an end",
       [](About&, auto&, auto& exchanges) { exchanges[0].status.time = kInfinite; },
       "in exchange 0, a status.time that is not a finite number"},
      {"a segment without an end",
       [](About&, auto& requests, auto&) { requests[0] = Segment{.duration = kInfinite}; },
       "in a request before exchange 0, a duration that is not a finite number"},
      {"a PWM that is no number, in a change of outputs",
       [](About&, auto& requests, auto&) {
         requests[0] = ChangeOutputs{{.pwm = OutputChange::Pwm{1, kNan}}};
       },
       "before exchange 0, a change.pwm.value.value that is not a finite number"},
      {"a clock that goes back", [](About&, auto&, auto& exchanges) { exchanges[2].now = 1.0; },
       "exchange 2 1 s before"},
      {"a clock beyond all computers",
       [](About&, auto&, auto& exchanges) { exchanges[2].now = 1e10; }, "no computer's clock"},
      {"exchanges of hours", [](About&, auto&, auto& exchanges) { exchanges[2].now = 4000.0; },
       "more than 60 s"},
      {"no step frequency",
       [](About& about, auto&, auto&) { about.driver.max_step_frequency = 0.0; },
       "max_step_frequency of 0, which has to be 1 to 495000"},
      {"a time-out that is no number",
       [](About& about, auto&, auto&) { about.driver.host_timeout = kNan; }, "host_timeout of nan"},
      {"a time-out below nothing",
       [](About& about, auto&, auto&) { about.driver.index_timeout = -1.0; },
       "index_timeout of -1"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.rule);
    About about;
    std::vector<Request> requests(1);
    std::vector<Exchange> exchanges{exchange_at(1.0), exchange_at(2.0), exchange_at(3.0)};
    row.spoil(about, requests, exchanges);
    Ring ring(1024);
    std::visit([&](const auto& request) { ring.write(request); }, requests[0]);
    for (const Exchange& exchange : exchanges) ring.write(exchange);
    const auto trace = parse_trace(trace_bytes(about, ring.copy(), 1e12), "bad.trace");
    REQUIRE_FALSE(trace);
    CHECK(trace.error().code == ErrorCode::trace_damaged);
    CHECK_THAT(trace.error().message, Contains("bad.trace") && Contains(row.says));
  }
}

TEST_CASE("More requests than a server keeps are refused before they are read", "[hal][trace]") {
  Ring ring(1024);
  ring.write(exchange_at(1.0));
  std::vector<std::uint64_t> words(kMostRequests + 1, RecordHead{kKindOf<QuickStop>, 0}.word());
  const auto exchange = ring.copy();
  words.insert(words.end(), exchange.begin(), exchange.end());
  const auto too_many = parse_trace(trace_bytes({}, words), "bad.trace");
  REQUIRE_FALSE(too_many);
  CHECK_THAT(too_many.error().message, Contains("more than 300000 requests"));
  words.erase(words.begin());
  CHECK(parse_trace(trace_bytes({}, words), "good.trace"));
}

TEST_CASE("A trace with what no board says is read, but not replayed", "[hal][trace]") {
  struct Row {
    const char* rule;
    void (*spoil)(Trace&);
    const char* says;
  };
  const Row rows[] = {
      {"a board time that jumps", [](Trace& trace) { trace.steps[2].exchange.status.time = 1e6; },
       "In exchange 2 the board's time has gone from 0.002 to 1000000 s"},
      {"a board time that goes back",
       [](Trace& trace) { trace.steps[2].exchange.status.time = 0.001; },
       "In exchange 2 the board's time goes back from 0.004 to 0.001 s"},
      {"a board time before power-up",
       [](Trace& trace) { trace.steps[0].exchange.status.time = -5.0; },
       "In exchange 0 the board's time is -5 s"},
      {"more than all of a segment",
       [](Trace& trace) { trace.steps[1].exchange.status.executing_phase = 1.5; },
       "In exchange 1 1.5 of the segment"},
      {"a position beyond all machines",
       [](Trace& trace) { trace.steps[1].exchange.status.position[Axis::A] = 1e12; },
       "In exchange 1 a position is farther"},
      {"a segment beyond all machines",
       [](Trace& trace) { trace.steps[1].requests = {Segment{.position = {.values = {1e300}}}}; },
       "In exchange 1 a segment goes farther"},
      {"a segment of a year",
       [](Trace& trace) { trace.steps[1].requests = {Segment{.duration = 3e7}}; },
       "In exchange 1 a segment takes 30000000 s"},
      {"an axis put beyond all machines",
       [](Trace& trace) {
         trace.steps[1].requests = {SetPosition{Axis::X, 1e12}};
       },
       "In exchange 1 an axis is put"},
  };
  auto machine = sim::small_machine();
  for (const Axis axis : {Axis::A, Axis::B, Axis::C})
    machine.axes[axis] = {.positive_limit = 300.0, .velocity = 75.0, .acceleration = 3000.0};
  Ring ring;
  TracedController controller(
      sim::make_virtual_controller(machine, {.machine = {.start = Position{}}}), ring);
  REQUIRE(controller.connect());
  for (int i = 0; i < 10; ++i) controller.exchange(1.0 + 0.002 * i);
  Trace sound = trace_of(ring);
  sound.about.config = config::machine_config_text(machine);
  REQUIRE(replay(sound));
  for (std::size_t i = 0; i < sound.steps.size(); ++i)
    sound.steps[i].exchange.status.time = 0.002 * static_cast<double>(i + 1);
  REQUIRE(replay(sound));
  for (const Row& row : rows) {
    CAPTURE(row.rule);
    Trace trace = sound;
    row.spoil(trace);
    const auto report = replay(trace);
    REQUIRE_FALSE(report);
    CHECK(report.error().code == ErrorCode::trace_cannot_begin);
    CHECK_THAT(report.error().message, Contains(row.says));
  }
}

TEST_CASE("A trace with other fields names the version that reads it", "[hal][trace]") {
  std::string bytes = sound_file();
  const std::size_t place = bytes.find("record 0\n");
  REQUIRE(place != std::string::npos);
  bytes.replace(place, 8, "record 9");
  const std::string changed = "record 9" + layout().substr(8);
  const std::uint32_t crc = cpu5::wire::crc32(
      std::span(reinterpret_cast<const std::uint8_t*>(changed.data()), changed.size()));
  std::memcpy(bytes.data() + place + changed.size(), &crc, sizeof crc);
  const auto trace = parse_trace(bytes, "old.trace");
  REQUIRE_FALSE(trace);
  CHECK(trace.error().code == ErrorCode::trace_of_other_version);
  CHECK_THAT(trace.error().message, Contains("version 1.2.3"));
}

}  // namespace
}  // namespace cnc::hal::trace
