// A board that has gone mad: whatever it says, the server does not crash, moves nothing that nobody
// asked for, comes to rest with the spindle off, and an error says what was wrong (LNK-9).
//
// It is the virtual board with its virtual machine, behind the real driver and link; what it says
// is changed on its way to the host. So what really happens can be looked at.
#include <catch2/catch.hpp>
#include <optional>
#include <random>

#include "hal/cpu5/wire/crc32.h"
#include "hal/sim/virtual_controller.h"
#include "tests/server/rig.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using hal::cpu5::PacketChannel;
namespace firmware = hal::cpu5::firmware;
namespace wire = hal::cpu5::wire;

namespace {

/// What comes from the board, before it reaches the host.
struct Said {
  wire::StatusNumbers numbers;
  firmware::Status status;
  std::mt19937& random;

  [[nodiscard]] std::uint32_t anything() { return static_cast<std::uint32_t>(random()); }
  [[nodiscard]] bool one_in(std::uint32_t chances) { return anything() % chances == 0; }
  [[nodiscard]] std::int64_t any_count() { return static_cast<std::int32_t>(anything()); }
};
using Twist = void (*)(Said&);

/// How packets come back.
enum class Way : std::uint8_t {
  whole,
  not_at_all,
  as_rubbish,
  of_another_version,
  greeting_only,
};

class MadChannel final : public PacketChannel {
 public:
  explicit MadChannel(const MachineData& data)
      : inner_(data.config, hal::sim::Scenario{.machine = at_zero().machine}) {}

  [[nodiscard]] hal::sim::VirtualBoard& board() { return inner_.board(); }
  Twist twist = nullptr;
  Way way = Way::whole;

  Result<void> open() override { return inner_.open(); }
  void close() override { inner_.close(); }
  void set_time(double now) override { inner_.set_time(now); }
  void send(std::span<const std::uint8_t> packet) override { inner_.send(packet); }
  std::span<const std::uint8_t> receive() override {
    const auto packet = inner_.receive();
    if (packet.empty() || way == Way::not_at_all) return {};
    auto received = wire::open_packet(packet);
    REQUIRE(received);
    const wire::PacketHeader& header = received->header;
    const bool is_status = header.type == wire::PacketType::status;
    if (way == Way::greeting_only && is_status) return {};
    if (way == Way::as_rubbish || way == Way::of_another_version) return spoiled(packet);
    if (twist == nullptr || !is_status) return packet;
    Said said{.numbers = {}, .status = {}, .random = random_};
    REQUIRE(wire::get_status(received->body, said.numbers, said.status));
    twist(said);
    wire::PacketWriter writer(memory_, wire::PacketType::status, header.session);
    wire::put_status(writer.body(), said.numbers, said.status);
    return writer.finish();
  }
  [[nodiscard]] std::string name() const override { return "the mad board"; }

 private:
  [[nodiscard]] std::span<const std::uint8_t> spoiled(std::span<const std::uint8_t> packet) {
    std::ranges::copy(packet, memory_.begin());
    const auto bytes = std::span(memory_).first(packet.size());
    if (way == Way::as_rubbish) {
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random_());
      return bytes;
    }
    bytes[2] = wire::kVersion + 1;
    const auto content = bytes.first(bytes.size() - wire::kCrcSize);
    wire::ByteWriter(bytes.last(wire::kCrcSize)).put(wire::crc32(content));
    return bytes;
  }

  hal::sim::VirtualChannel inner_;
  std::mt19937 random_{1};
  std::array<std::uint8_t, wire::kMaxPacket> memory_{};
};

/// A whole server on a board that is sane until it is told to be mad.
class MadRig {
 public:
  MadRig() : MadRig(free_machine(), nullptr) {}

  hal::sim::VirtualMachine& bench() { return channel_->board().machine(); }
  Machine& machine() { return machine_; }
  void run_for(double seconds) {
    for (const double end = now_ + seconds; now_ < end; now_ += 0.005) {
      link_.cycle(now_);
      machine_.cycle(now_);
      if (bench().physical_position() != place_) moved_at_ = now_;
      place_ = bench().physical_position();
    }
  }
  [[nodiscard]] bool becomes(State state, double seconds) {
    for (const double end = now_ + seconds; now_ < end && machine_.state() != state;)
      run_for(0.005);
    return machine_.state() == state;
  }
  void go_mad(Twist twist, Way way) {
    channel_->twist = twist;
    channel_->way = way;
  }
  void reset() {
    machine_.reset([](const Result<void>&) {});
    REQUIRE(becomes(State::ready, 1.0));
  }
  void start(const std::string& text) {
    auto program = interp::Program::from_text(text, "mad.nc");
    REQUIRE(program);
    REQUIRE(machine_.load(*program, "mad.nc"));
    REQUIRE(machine_.run());
  }
  /// When the real machine moved last.
  [[nodiscard]] double moved_at() const { return moved_at_; }
  [[nodiscard]] double now() const { return now_; }
  /// Where the real machine stood at the beginning.
  [[nodiscard]] const Position& begin() const { return begin_; }
  /// What the operator sees.
  [[nodiscard]] std::string story() const {
    std::string story = machine_.snapshots().newest()->state_text;
    for (const LogMessage& message : log_.after(0)) story += "\n" + message.text;
    return story;
  }
  [[nodiscard]] bool told_any() const {
    return std::ranges::any_of(log_.after(0),
                               [](const LogMessage& m) { return m.error.has_value(); });
  }
  /// The first such error.
  [[nodiscard]] std::optional<Error> told(ErrorCode code) const {
    for (const LogMessage& message : log_.after(0))
      if (message.error && message.error->code == code) return message.error;
    return std::nullopt;
  }

 private:
  MadRig(MachineData data, MadChannel* channel)
      : link_(controller(data, channel)), machine_(std::move(data), link_, log_) {
    channel_ = channel;
    place_ = begin_ = bench().physical_position();
    REQUIRE(becomes(State::needs_reset, 1.0));
  }
  static std::unique_ptr<hal::Controller> controller(const MachineData& data,
                                                     MadChannel*& channel) {
    auto owned = std::make_unique<MadChannel>(data);
    channel = owned.get();
    auto driver = std::make_unique<hal::cpu5::Cpu5Driver>(
        data.config, hal::cpu5::driver_settings(data.config),
        std::make_unique<hal::cpu5::WirePort>(std::move(owned), hal::cpu5::WireSettings{}));
    REQUIRE(driver->connect());
    return driver;
  }

  MessageLog log_;
  Link link_;
  Machine machine_;
  MadChannel* channel_ = nullptr;  // the driver's port owns it
  Position begin_;
  Position place_;
  double moved_at_ = 0.0;
  double now_ = 10.0;
};

/// What a board may say, and what becomes of a job then.
struct Row {
  const char* name;
  /// Of the error that ends the job; none: it comes to its end.
  std::optional<ErrorCode> ends_by;
  Twist twist;
  Way way = Way::whole;
};

void say_anything(Said& said) {
  firmware::Status& status = said.status;
  status.faults = static_cast<firmware::FaultBits>(said.one_in(8) ? said.anything() : 0);
  status.executing_id = said.anything();
  status.moving = said.one_in(2);
  status.cut_late = said.one_in(2);
  status.path_stop = static_cast<firmware::PathStop>(said.anything() % 3);
  status.fifo_free = said.anything() % 0x10000;
  for (std::int64_t& count : status.counts) count = said.any_count();
}

void catch_all(Said& said) {
  for (firmware::HomeLatch& latch : said.status.home_latch)
    latch = {.armed = true, .caught = true, .count = said.any_count()};
  said.status.probe_latch = {.armed = true, .caught = true, .active_at_arming = true};
  said.status.estop_latch.count = said.anything();
}

constexpr auto kLost = ErrorCode::link_lost;
constexpr auto kFault = ErrorCode::motion_fault;

const Row kRows[] = {
    {"silence", kLost, nullptr, Way::not_at_all},
    {"rubbish", kLost, nullptr, Way::as_rubbish},
    {"another version", kLost, nullptr, Way::of_another_version},
    {"silence behind the greeting", kLost, nullptr, Way::greeting_only},
    // Of the packets.
    {"answers that do not count up", kLost, [](Said& said) { said.numbers.answer = 7; }},
    {"frames executed that were not sent", kLost, [](Said& said) { said.numbers.executed += 100; }},
    {"frames that are never executed", kLost, [](Said& said) { said.numbers.executed = 0; }},
    {"any numbers", kLost,
     [](Said& said) {
       said.numbers.answer = said.anything();
       said.numbers.executed = said.anything();
     }},
    {"all frames wait", {}, [](Said& said) { said.numbers.waiting = ~0U; }},
    {"any stamp", {}, [](Said& said) { said.numbers.stamp = said.anything(); }},
    // Of the board.
    {"a time that stands", {}, [](Said& said) { said.status.time = 1; }},
    {"any time", {}, [](Said& said) { said.status.time = said.any_count() * said.any_count(); }},
    {"all faults", ErrorCode::estop_pressed, [](Said& said) { said.status.faults = 0xFFFF; }},
    {"a fault that nobody knows", kFault, [](Said& said) { said.status.faults = 0x8000; }},
    {"drives on that nobody switched on",
     {},
     [](Said& said) { said.status.outputs.drives_enabled = true; }},
    {"drives off that were switched on",
     {},
     [](Said& said) { said.status.outputs.drives_enabled = false; }},
    // Of the path.
    {"any segment", kFault, [](Said& said) { said.status.executing_id = said.anything(); }},
    {"a segment far ahead", kFault, [](Said& said) { said.status.executing_id += 100'000; }},
    {"no segment", kFault, [](Said& said) { said.status.executing_id = 0; }},
    {"more made of a segment than there is",
     {},
     [](Said& said) { said.status.executing_elapsed = 0xFFFF'FFFF; }},
    {"a full FIFO", kFault, [](Said& said) { said.status.fifo_free = 0; }},
    {"an endless FIFO", kFault,
     [](Said& said) { said.status.fifo_free = said.status.fifo_count = 0xFFFF; }},
    {"less than no motion left",
     {},
     [](Said& said) { said.status.queued_time = -(std::int64_t{1} << 60U); }},
    {"always in motion", kFault, [](Said& said) { said.status.moving = true; }},
    {"never in motion", {}, [](Said& said) { said.status.moving = false; }},
    {"every cut is late", {}, [](Said& said) { said.status.cut_late = true; }},
    {"stopping for ever",
     {},
     [](Said& said) { said.status.path_stop = firmware::PathStop::stopping; }},
    {"stopped for ever", kFault,
     [](Said& said) { said.status.path_stop = firmware::PathStop::stopped; }},
    {"any speed of path time", {}, [](Said& said) { said.status.time_scale = said.anything(); }},
    // Of counts, inputs and latches.
    {"absurd counts", {}, [](Said& said) { said.status.counts.fill(0x7FFF'FFFF); }},
    {"any counts",
     {},
     [](Said& said) {
       for (std::int64_t& count : said.status.counts) count = said.any_count();
     }},
    {"all inputs",
     {},
     [](Said& said) {
       said.status.inputs.home = 0x3F;
       said.status.inputs.ports = ~std::uint64_t{0};
       said.status.inputs.probe = true;
     }},
    {"any analog inputs",
     {},
     [](Said& said) {
       for (std::uint32_t& analog : said.status.inputs.analog) analog = said.anything();
     }},
    {"any guard rules",
     {},
     [](Said& said) {
       for (std::uint8_t& count : said.status.guard_counts)
         count = static_cast<std::uint8_t>(said.anything());
     }},
    {"all latches", {}, catch_all},
    {"anything at all", ErrorCode::estop_pressed, say_anything},
};

}  // namespace

TEST_CASE("A board that goes mad moves nothing by itself, and a reset is answered",
          "[LNK-9][safety]") {
  for (const Row& row : kRows) {
    CAPTURE(row.name);
    MadRig rig;
    rig.run_for(0.1);
    const double begin = rig.now();
    rig.go_mad(row.twist, row.way);
    rig.run_for(3.0);
    bool answered = false;
    rig.machine().reset([&](const Result<void>& result) {
      answered = true;
      if (!result) CHECK(result.error().message.size() > 20);
    });
    rig.run_for(5.0);
    CHECK(answered);
    CHECK(rig.moved_at() < begin);
    CHECK_FALSE(rig.bench().outputs().spindle_on);
    if (row.way != Way::whole) CHECK(rig.told(ErrorCode::link_lost));
  }
}

TEST_CASE("A board that goes mad in a job: it comes to its end, or an error says what was wrong",
          "[LNK-9][safety]") {
  for (const Row& row : kRows) {
    for (const bool with_hold : {false, true}) {
      CAPTURE(row.name, with_hold);
      MadRig rig;
      rig.reset();
      rig.start("M3 S6000\nG1 X50 F3000\nY20\nX0\nY0\nM30\n");
      rig.run_for(1.5);
      REQUIRE(rig.bench().outputs().spindle_on);
      rig.go_mad(row.twist, row.way);
      if (with_hold) {
        rig.run_for(0.1);
        rig.machine().pause([](const Result<void>&) {});
        rig.run_for(2.0);
        if (rig.machine().state() == State::paused) REQUIRE(rig.machine().resume());
      }
      rig.run_for(12.0);
      INFO(rig.story());
      CHECK(rig.moved_at() < rig.now() - 2.0);
      CHECK_FALSE(rig.bench().outputs().spindle_on);
      const Position there = rig.bench().physical_position();
      const bool ended_well = rig.machine().snapshots().newest()->job.ended_well;
      // What a hold comes to depends on the instant.
      if (with_hold) {
        CHECK((ended_well || rig.told_any()));
      } else {
        CHECK(ended_well == !row.ends_by);
        if (row.ends_by) CHECK(rig.told(*row.ends_by));
      }
      if (ended_well) CHECK(motion::norm(there - rig.begin()) < 1e-9);
    }
  }
}

TEST_CASE("A server tells what is wrong with a board that never makes sense", "[LNK-9][LNK-1]") {
  struct Case {
    Way way;
    Twist twist;
    ErrorCode code;
    const char* text;
  };
  const Case sort = GENERATE(values<Case>({
      {Way::not_at_all, nullptr, ErrorCode::board_silent, "does not answer"},
      {Way::as_rubbish, nullptr, ErrorCode::board_silent, "does not answer"},
      {Way::of_another_version, nullptr, ErrorCode::board_silent, "does not answer"},
      {Way::greeting_only, nullptr, ErrorCode::board_version, "gives no status that makes sense"},
      {Way::whole, [](Said& said) { said.numbers.executed += 100; }, ErrorCode::board_version,
       "gives no status that makes sense"},
  }));
  MadRig rig;
  rig.go_mad(sort.twist, sort.way);
  rig.run_for(12.0);
  CHECK(rig.machine().state() == State::off);
  REQUIRE(rig.told(sort.code));
  CHECK_THAT(rig.told(sort.code)->message, Catch::Contains(sort.text));
}
