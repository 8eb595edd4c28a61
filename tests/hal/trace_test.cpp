// The trace of the link: what is recorded, as a file, and read again; and files that are none.
#include <catch2/catch.hpp>
#include <cstring>
#include <thread>

#include "hal/cpu5/wire/crc32.h"
#include "hal/trace/ring.h"
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
  // 20 words a segment, 65 an exchange: three or four of these groups fit.
  std::uint32_t id = 0;
  for (int i = 1; i <= 1000; ++i) {
    for (int k = 0; k < 10; ++k) ring.write(Segment{.id = ++id, .duration = 0.001});
    ring.write(exchange_at(0.002 * i));
    const auto words = ring.copy();
    REQUIRE(words.size() <= 1024);
    REQUIRE(words.size() > (i > 10 ? 1024U - 66U : 0U));  // no more room than a record is wasted
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
