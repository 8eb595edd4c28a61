// Both ends of the wire at a mad neighbour: whatever whole packets come, in any order, a board
// neither crashes nor steps faster than it may, and a host neither crashes nor loses count.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/cpu5/driver/wire_port.h"
#include "hal/cpu5/firmware/board_link.h"
#include "hal/cpu5/wire/crc32.h"

namespace {

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::cpu5;

constexpr firmware::StepVelocity kLimit = firmware::velocity_of_frequency(400'000);

void require(bool condition) {
  if (!condition) std::abort();
}

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t value = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return value;
  }
  /// A packet that is whole, of this session, with a body from the input.
  std::vector<std::uint8_t> packet(std::uint32_t session) {
    constexpr std::uint8_t kTypes[] = {0x01, 0x02, 0x03, 0x03, 0x03, 0x04, 0x05,
                                       0x81, 0x82, 0x83, 0x83, 0x84, 0x7F};
    std::vector<std::uint8_t> memory(wire::kMaxPacket);
    const std::uint8_t choice = byte();
    const auto type = static_cast<wire::PacketType>(kTypes[choice % sizeof kTypes]);
    wire::PacketWriter writer(memory, type, (choice & 0x80) != 0 ? byte() : session);
    const auto size = std::min<std::size_t>(bytes_.size(), byte() * 4U);
    for (std::size_t i = 0; i < size; ++i) writer.body().put(byte());
    const auto whole = writer.finish();
    memory.resize(whole.size());
    return memory;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

class CountedPins final : public firmware::BoardIo {
 public:
  void step(std::size_t axis, int, firmware::Ticks) override { ++pulses[axis]; }
  firmware::Inputs inputs(firmware::Ticks) override { return {}; }
  void set_outputs(const firmware::Outputs&) override {}

  firmware::PerAxis<std::int64_t> pulses{};
};

void attack_board(Input input) {
  CountedPins pins;
  firmware::Core core(pins);
  firmware::BoardLink link(core, {});
  std::vector<std::uint8_t> memory(wire::kMaxPacket);
  const auto hello = [&] {
    std::vector<std::uint8_t> packet(wire::kMaxPacket);
    wire::PacketWriter writer(packet, wire::PacketType::hello, 1);
    wire::put_setup(writer.body(),
                    {.max_velocity = kLimit, .host_timeout = firmware::kTicksPerSecond / 10});
    const auto whole = writer.finish();
    static_cast<void>(link.answer(whole, memory));
  };
  hello();
  while (!input.empty()) {
    const firmware::Ticks passing = input.byte() * firmware::Ticks{500};
    core.advance(passing);
    for (std::int64_t& pulses : pins.pulses) {
      require(pulses <= ((passing + 4 * firmware::kSliceTicks) * firmware::kTopVelocity >>
                         firmware::kFractionBits) +
                            2);
      pulses = 0;
    }
    const auto answer = link.answer(input.packet(1), memory);
    require(answer.empty() || wire::open_packet(answer));
    if (input.byte() == 0) hello();
  }
}

/// What the host has sent is looked at for its session only.
class MadBoard final : public PacketChannel {
 public:
  explicit MadBoard(Input input) : input_(input) {}

  Result<void> open() override { return {}; }
  void close() override {}
  void send(std::span<const std::uint8_t> packet) override {
    const auto opened = wire::open_packet(packet);
    require(opened.has_value());
    session_ = opened->header.session;
    greeted_ = greeted_ || opened->header.type == wire::PacketType::hello;
  }
  std::span<const std::uint8_t> receive() override {
    if (welcome_due()) return welcome();
    if (input_.empty() || input_.byte() % 4 == 0) return {};
    packet_ = input_.packet(session_);
    return packet_;
  }
  [[nodiscard]] std::string name() const override { return "mad"; }
  [[nodiscard]] bool exhausted() const { return input_.empty(); }

 private:
  /// Often enough, so that the fuzzer gets into a session.
  [[nodiscard]] bool welcome_due() const { return greeted_; }
  std::span<const std::uint8_t> welcome() {
    greeted_ = false;
    packet_.resize(wire::kMaxPacket);
    wire::PacketWriter writer(packet_, wire::PacketType::welcome, session_);
    wire::put_identity(writer.body(), {.max_step_frequency = 499'999,
                                       .fifo_capacity = 256,
                                       .axes = firmware::kAxisCount,
                                       .window = 8});
    return writer.finish();
  }

  Input input_;
  std::uint32_t session_ = 0;
  bool greeted_ = false;
  std::vector<std::uint8_t> packet_;
};

void attack_host(Input input) {
  auto channel = std::make_unique<MadBoard>(input);
  const MadBoard& board = *channel;
  WirePort port(std::move(channel), {});
  firmware::HostFrame frame;
  frame.segment_count = 3;
  // open() would wait for real time: the port greets in its exchanges all the same.
  port.begin({.max_velocity = kLimit});
  double now = 0.0;
  for (int i = 0; i < 10'000 && !board.exhausted(); ++i) {
    now += 0.003;
    port.receive(now);
    if (port.ready()) port.send(frame);
    if (i % 50 == 49) port.quick_stop();
    const BoardAnswer& answer = port.exchange();
    require(answer.frames_done <= port.frames_sent());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Input input(data + 1, size - 1);
  if (data[0] % 2 == 0) {
    attack_board(input);
  } else {
    attack_host(input);
  }
  return 0;
}
