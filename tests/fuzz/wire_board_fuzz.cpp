// A board with a mad host: whatever whole packets come, in any order, between any inputs, it
// neither crashes nor steps faster than it may, and what it answers is understood.
#include <memory>
#include <vector>

#include "hal/cpu5/firmware/board_link.h"
#include "tests/fuzz/link_values.h"

namespace {

using cnc::fuzz::require;
using namespace cnc::hal::cpu5::firmware;
using namespace cnc::hal::cpu5;

class CountedPins final : public BoardIo {
 public:
  void step(std::size_t axis, int, Ticks) override { ++pulses[axis]; }
  Inputs inputs(Ticks) override { return present; }
  void set_outputs(const Outputs&) override {}

  PerAxis<std::int64_t> pulses{};
  Inputs present{};
};

class Run {
 public:
  explicit Run(Bytes bytes) : bytes_(bytes) {}

  void go() {
    say(wire::PacketType::hello);
    while (!bytes_.empty()) {
      pass(bytes_.flag() ? bytes_.next<std::uint16_t>() : bytes_.byte() * Ticks{10});
      for (auto changes = bytes_.below(4); changes > 0; --changes)
        vary(bytes_, pins_.present, core_.time());
      say(next_type());
    }
  }

 private:
  /// The way at the session's highest speed in that time; none behind a fault. After an index pulse
  /// up to one slice may be owed, and rounding to whole steps is worth one more.
  void pass(Ticks ticks) {
    const bool faulty_before = core_.status().faults != 0;
    core_.advance(ticks);
    const std::int64_t most = ((ticks + kSliceTicks) * max_velocity_ >> kFractionBits) + 2;
    for (std::int64_t& pulses : pins_.pulses) {
      require(pulses <= (faulty_before ? 0 : most));
      pulses = 0;
    }
    if (bytes_.below(64) == 63) core_.advance(2 * kTicksPerSecond);  // a host that was away
    pins_.pulses = {};
  }

  [[nodiscard]] wire::PacketType next_type() {
    using enum wire::PacketType;
    constexpr wire::PacketType kTypes[] = {frame, frame, frame, frame,    frame,   poll,
                                           hello, bye,   hello, identify, welcome, status};
    const auto choice = bytes_.byte();
    return choice < 240 ? kTypes[choice % std::size(kTypes)]
                        : static_cast<wire::PacketType>(bytes_.byte());
  }

  void say(wire::PacketType type) {
    std::vector<std::uint8_t> memory(wire::kMaxPacket);
    if (type == wire::PacketType::hello && bytes_.below(4) != 3) ++session_;
    wire::PacketWriter packet(memory, type, bytes_.below(32) == 31 ? bytes_.byte() : session_);
    put_body(type, packet.body());
    for (auto flaws = bytes_.byte(); flaws > 250; --flaws)
      memory[2U + bytes_.next<std::uint16_t>() % 256U] = bytes_.byte();
    const bool was_in_session = link_.in_session();
    const auto sent = packet.finish();
    const auto answer = link_.answer(sent, answer_);
    read(answer);
    if (is_of(wire::PacketType::welcome, answer)) note_setup(sent, was_in_session);
  }

  static bool is_of(wire::PacketType type, std::span<const std::uint8_t> packet) {
    const auto opened = wire::open_packet(packet);
    return opened && opened->header.type == type;
  }

  /// A greeting that comes again is welcomed again and sets nothing up.
  void note_setup(std::span<const std::uint8_t> sent, bool was_in_session) {
    auto hello = wire::open_packet(sent);
    require(hello.has_value());
    if (was_in_session && hello->header.session == welcomed_) return;
    Setup setup;
    require(wire::get_setup(hello->body, setup));
    max_velocity_ = setup.max_velocity;
    welcomed_ = hello->header.session;
  }

  void put_body(wire::PacketType type, wire::ByteWriter& body) {
    if (bytes_.below(16) == 15) {
      for (auto size = bytes_.byte(); size > 0; --size) body.put(bytes_.byte());
    } else if (type == wire::PacketType::hello) {
      wire::put_setup(body, next_setup(bytes_));
    } else if (type == wire::PacketType::frame || type == wire::PacketType::poll) {
      put_frame_or_poll(type, body);
    }
  }

  /// Frames come early, doubled and out of order; some ask for a quick stop that overtakes others.
  void put_frame_or_poll(wire::PacketType type, wire::ByteWriter& body) {
    const auto order = bytes_.byte();
    const std::uint32_t ahead = order < 192 ? 1 : order % 36U;
    if (bytes_.below(32) == 31) ++stops_;
    const bool is_frame = type == wire::PacketType::frame;
    wire::put_numbers(body, {.sequence = is_frame ? executed_ + ahead : 0,
                             .stops = stops_ - (bytes_.below(32) == 30 ? 1U : 0U),
                             .stamp = bytes_.byte()});
    if (!is_frame) return;
    frames_.fill(bytes_, *frame_, status_);
    wire::put_frame(body, *frame_);
  }

  void read(std::span<const std::uint8_t> answer) {
    if (answer.empty()) return;
    auto packet = wire::open_packet(answer);
    require(packet.has_value());
    wire::StatusNumbers numbers;
    wire::Identity identity;
    wire::Refusal refusal;
    switch (packet->header.type) {
      case wire::PacketType::status:
        require(wire::get_status(packet->body, numbers, status_));
        executed_ = numbers.executed;
        return;
      case wire::PacketType::welcome:
        require(wire::get_identity(packet->body, identity));
        executed_ = stops_ = 0;
        return;
      case wire::PacketType::identity:
        return require(wire::get_identity(packet->body, identity));
      default:
        require(packet->header.type == wire::PacketType::refusal);
        return require(wire::get_refusal(packet->body, refusal));
    }
  }

  Bytes bytes_;
  CountedPins pins_;
  Core core_{pins_};
  BoardLink link_{core_, {}};
  std::vector<std::uint8_t> answer_ = std::vector<std::uint8_t>(wire::kMaxPacket);
  Status status_{};                // as last heard
  StepVelocity max_velocity_ = 0;  // of the session
  std::uint32_t session_ = 0;
  std::uint32_t welcomed_ = 0;
  std::uint32_t executed_ = 0;
  std::uint32_t stops_ = 0;
  FrameMaker frames_;
  std::unique_ptr<HostFrame> frame_ = std::make_unique<HostFrame>();
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::make_unique<Run>(Bytes(data, size))->go();
  return 0;
}
