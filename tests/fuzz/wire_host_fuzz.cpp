// A host, port and driver, with a mad board, and with somebody who asks the driver for anything:
// whatever whole packets come, in any order, it neither crashes nor loses count, and what it sends
// is understood.
#include <cmath>
#include <deque>
#include <memory>
#include <vector>

#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/cpu5/driver/wire_port.h"
#include "tests/fuzz/link_values.h"

namespace {

using namespace cnc;
using namespace cnc::fuzz;
using namespace cnc::hal::cpu5;
using firmware::kFifoCapacity;
using wire::PacketType;

using Packet = std::vector<std::uint8_t>;

/// Answers properly while the host connects, because that takes real time otherwise.
class MadBoard final : public PacketChannel {
 public:
  explicit MadBoard(Bytes& bytes) : bytes_(bytes) {}

  Result<void> open() override { return {}; }
  void close() override {}
  void send(std::span<const std::uint8_t> packet) override {
    auto opened = wire::open_packet(packet);
    require(opened && opened->header.version == wire::kVersion && opened->header.session != 0);
    session_ = opened->header.session;
    understand(opened->header.type, opened->body);
  }
  std::span<const std::uint8_t> receive() override {
    packet_.clear();
    if (!proper_.empty()) {
      packet_ = std::move(proper_.front());
      proper_.pop_front();
    } else if (!connecting && !bytes_.empty() && bytes_.below(4) != 0) {
      packet_ = next_packet();
    }
    return packet_;
  }
  [[nodiscard]] std::string name() const override { return "mad"; }

  bool connecting = false;

 private:
  void understand(PacketType type, wire::ByteReader& body) {
    if (type == PacketType::hello) {
      firmware::Setup setup;
      require(wire::get_setup(body, setup));
      executed_ = newest_ = answers_ = 0;
      status_ = {.fifo_free = kFifoCapacity};
      if (connecting || bytes_.below(8) != 7) proper_.push_back(welcome({.window = 32}));
      return;
    }
    if (type == PacketType::bye) return;
    require(type == PacketType::frame || type == PacketType::poll);
    const wire::FrameNumbers numbers = wire::get_frame_numbers(body);
    require((type == PacketType::poll) == (numbers.sequence == 0));
    if (type == PacketType::frame) {
      require(wire::get_frame(body, *frame_));
      require(numbers.sequence <= newest_ + 1);  // of the window it may have been told anything
      newest_ = std::max(newest_, numbers.sequence);
    }
    stamp_ = numbers.stamp;
    if (connecting) proper_.push_back(status());
  }

  [[nodiscard]] Packet next_packet() {
    switch (bytes_.below(16)) {
      case 0:
        return welcome({.boot = bytes_.byte(), .window = bytes_.below<std::uint8_t>(40)});
      case 1:
        return packet(PacketType::refusal, [&](wire::ByteWriter& body) {
          wire::put_refusal(body, {.reason = static_cast<wire::RefusalReason>(bytes_.byte()),
                                   .boot = bytes_.byte()});
        });
      case 2:
        return packet(static_cast<PacketType>(bytes_.byte()), [&](wire::ByteWriter& body) {
          for (auto size = bytes_.byte(); size > 0; --size) body.put(bytes_.byte());
        });
      default:
        for (auto changes = bytes_.below(4); changes > 0; --changes) vary(bytes_, status_);
        if (bytes_.flag()) executed_ = newest_;
        return status();
    }
  }

  [[nodiscard]] Packet welcome(wire::Identity identity) {
    identity.max_step_frequency = connecting ? 499'999 : bytes_.next<std::uint32_t>();
    identity.fifo_capacity =
        connecting || bytes_.flag() ? std::uint16_t{kFifoCapacity} : bytes_.next<std::uint16_t>();
    identity.axes = static_cast<std::uint8_t>(kAxisCount);
    return packet(PacketType::welcome,
                  [&](wire::ByteWriter& body) { wire::put_identity(body, identity); });
  }

  [[nodiscard]] Packet status() {
    const bool wild = !connecting && bytes_.below(16) == 15;
    const wire::StatusNumbers numbers{.answer = wild ? bytes_.next<std::uint32_t>() : ++answers_,
                                      .executed = wild ? bytes_.next<std::uint32_t>() : executed_,
                                      .waiting = wild ? bytes_.next<std::uint32_t>() : 0,
                                      .stamp = wild ? bytes_.next<std::uint32_t>() : stamp_};
    return packet(PacketType::status,
                  [&](wire::ByteWriter& body) { wire::put_status(body, numbers, status_); });
  }

  /// Whole; of this session, mostly.
  template <typename Put>
  [[nodiscard]] Packet packet(PacketType type, Put put) {
    Packet memory(wire::kMaxPacket);
    const bool of_other = !connecting && bytes_.below(32) == 31;
    wire::PacketWriter writer(memory, type, of_other ? bytes_.byte() : session_);
    put(writer.body());
    if (!connecting)
      for (auto flaws = bytes_.byte(); flaws > 250; --flaws)
        memory[2U + bytes_.next<std::uint16_t>() % 256U] = bytes_.byte();
    memory.resize(writer.finish().size());
    return memory;
  }

  Bytes& bytes_;
  std::deque<Packet> proper_;
  Packet packet_;
  firmware::Status status_{.fifo_free = kFifoCapacity};
  std::uint32_t session_ = 0;
  std::uint32_t executed_ = 0;
  std::uint32_t newest_ = 0;
  std::uint32_t answers_ = 0;
  std::uint32_t stamp_ = 0;
  std::unique_ptr<firmware::HostFrame> frame_ = std::make_unique<firmware::HostFrame>();
};

config::MachineConfig some_machine(Bytes& bytes) {
  config::MachineConfig config;
  for (const Axis axis : kAllAxes) {
    config.axes[axis].steps_per_unit = bytes.flag() ? 200.0 : -1600.0;
    config.axes[axis].velocity = 100.0;
    config.axes[axis].acceleration = bytes.byte() * 10.0;
  }
  return config;
}

class Run {
 public:
  explicit Run(Bytes bytes) : bytes_(bytes) {
    auto board = std::make_unique<MadBoard>(bytes_);
    board_ = board.get();
    driver_ =
        std::make_unique<Cpu5Driver>(some_machine(bytes_), DriverSettings{},
                                     std::make_unique<WirePort>(std::move(board), WireSettings{}));
  }

  void go() {
    connect();
    while (!bytes_.empty()) {
      for (auto asked = bytes_.below(8); asked > 0; --asked) ask();
      now_ += bytes_.below(16) == 15 ? 0.05 * bytes_.byte() : 0.002;
      check(driver_->exchange(now_));
    }
  }

 private:
  void connect() {
    board_->connecting = true;
    require(driver_->connect().has_value());
    board_->connecting = false;
  }

  void check(const hal::ControllerStatus& status) {
    require(status.frames_done >= frames_done_ && status.frames_done < driver_->next_frame());
    frames_done_ = status.frames_done;
    require(status.sessions >= sessions_);
    sessions_ = status.sessions;
    require(status.connected || driver_->free_segments() == 0);
    for (const Axis axis : kAllAxes) require(std::isfinite(status.position[axis]));
  }

  /// A number as a planner makes it, or any.
  [[nodiscard]] double number() {
    return bytes_.below(16) == 15 ? bytes_.real() : 0.01 * bytes_.next<std::int16_t>();
  }

  void push() {
    std::vector<hal::Segment> segments(bytes_.below<std::size_t>(40));
    for (hal::Segment& segment : segments) {
      segment.id = ++id_;
      segment.duration = 1e-3 * number();
      const auto moves = bytes_.byte();
      for (const Axis axis : kAllAxes) {
        if ((moves >> index_of(axis) & 1U) == 0) continue;
        segment.position[axis] = number();
        segment.velocity[axis] = number();
      }
      if ((moves & 64U) != 0) segment.spindle_speed = number();
      segment.wait_for_index = (moves & 128U) != 0;
      if (moves % 8 == 7) segment.change = change();
    }
    const std::size_t room = driver_->free_segments();
    require(driver_->push(segments) <= room);
  }

  [[nodiscard]] hal::OutputChange change() {
    hal::OutputChange change;
    const auto bits = bytes_.byte();
    if ((bits & 1U) != 0) change.spindle_on = bytes_.flag();
    if ((bits & 2U) != 0) change.tool_direction = bytes_.flag();
    if ((bits & 4U) != 0) change.spindle_pwm = number();
    if ((bits & 8U) != 0) change.mist = bytes_.flag();
    if ((bits & 16U) != 0) change.flood = bytes_.flag();
    if ((bits & 32U) != 0) change.port = hal::OutputChange::Port{bytes_.byte(), bytes_.flag()};
    if ((bits & 64U) != 0) change.pwm = hal::OutputChange::Pwm{bytes_.byte(), number()};
    return change;
  }

  void ask() {
    const auto axis = kAllAxes[bytes_.below(kAllAxes.size())];
    switch (bytes_.below(20)) {
      case 0: {
        hal::Outputs outputs{.drives_enabled = bytes_.flag(), .spindle_pwm = number()};
        outputs.ports = hal::Ports(bytes_.next<std::uint64_t>());
        return driver_->set_outputs(outputs);
      }
      case 1:
        return static_cast<void>(driver_->change_outputs(change()));
      case 2:
        return driver_->quick_stop();
      case 3:
        return driver_->stop_along_path();
      case 4:
        return driver_->release_stop();
      case 5:
        return driver_->clear_faults();
      case 6:
        return static_cast<void>(driver_->set_position(axis, 0.01 * bytes_.next<std::int16_t>()));
      case 7:
        return driver_->arm_home_latch(axis, static_cast<hal::LatchEdge>(bytes_.flag()));
      case 8:
        return driver_->disarm_home_latch(axis);
      case 9:
        return driver_->arm_probe_latch();
      case 10:
        return driver_->disarm_probe_latch();
      case 11:
      case 12:
        return driver_->cut_behind(bytes_.below(4) == 3 ? bytes_.next<std::uint32_t>()
                                                        : id_ - bytes_.byte());
      case 13:
        if (bytes_.below(8) != 7) return;
        driver_->disconnect();
        return connect();
      default:
        return push();
    }
  }

  Bytes bytes_;
  MadBoard* board_ = nullptr;
  std::unique_ptr<Cpu5Driver> driver_;
  double now_ = 0.0;
  std::uint32_t id_ = 0;
  std::uint64_t frames_done_ = 0;
  std::uint32_t sessions_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Run({data, size}).go();
  return 0;
}
