// Packets to bytes and back: what goes in comes out, and nothing else gets through.
#include <catch2/catch.hpp>
#include <random>

#include "hal/cpu5/driver/serial_channel.h"
#include "hal/cpu5/wire/cobs.h"
#include "hal/cpu5/wire/crc32.h"
#include "hal/cpu5/wire/messages.h"

using namespace cnc::hal::cpu5;
using namespace cnc::hal::cpu5::wire;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes random_bytes(std::mt19937& random, std::size_t size, unsigned zeros) {
  Bytes bytes(size);
  for (auto& byte : bytes) {
    byte = random() % 100 < zeros ? std::uint8_t{0} : static_cast<std::uint8_t>(random());
  }
  return bytes;
}

template <typename T>
T any(std::mt19937& random) {
  return static_cast<T>((std::uint64_t{random()} << 32) | random());
}

/// Less than `end`.
std::uint32_t below(std::mt19937& random, std::uint64_t end) {
  return static_cast<std::uint32_t>(random() % end);
}

firmware::Outputs random_outputs(std::mt19937& random) {
  firmware::Outputs outputs;
  outputs.drives_enabled = any<bool>(random);
  outputs.mist = random() % 2 == 0;
  outputs.spindle_pwm = below(random, firmware::Outputs::kFullPwm + 1);
  outputs.ports = any<std::uint64_t>(random) >> (64 - firmware::kPortCount);
  for (auto& pwm : outputs.pwm) pwm = below(random, firmware::Outputs::kFullPwm + 1);
  return outputs;
}

firmware::OutputChange random_change(std::mt19937& random) {
  firmware::OutputChange change;
  change.changed = static_cast<std::uint8_t>(random() % 32);
  change.on = static_cast<std::uint8_t>(random()) & change.changed & 15;
  change.port = static_cast<std::uint8_t>(below(random, firmware::kPortCount + 1));
  change.pwm = static_cast<std::uint8_t>(below(random, firmware::kPwmCount + 1));
  const bool changes_speed = (change.changed & firmware::OutputChange::kSpindlePwm) != 0;
  if (changes_speed) change.spindle_pwm = below(random, firmware::Outputs::kFullPwm + 1);
  if (change.port != 0) change.port_on = random() % 2 == 0;
  if (change.pwm != 0) change.pwm_value = below(random, firmware::Outputs::kFullPwm + 1);
  return change;
}

firmware::HostFrame random_frame(std::mt19937& random) {
  firmware::HostFrame frame;
  frame.quick_stop = random() % 2 == 0;
  frame.release_stop = random() % 2 == 0;
  for (auto& request : frame.latch) request = static_cast<firmware::LatchRequest>(random() % 4);
  frame.probe = static_cast<firmware::ProbeRequest>(random() % 3);
  frame.with_next = random() % 2 == 0;
  frame.has_outputs = random() % 2 == 0;
  frame.outputs = random_outputs(random);
  if (random() % 2 == 0) frame.change = random_change(random);
  frame.segment_count = below(random, firmware::kSegmentsPerFrame + 1);
  frame.has_cut = random() % 2 == 0;
  frame.cut_behind = any<std::uint32_t>(random);
  frame.segments_before_cut = frame.has_cut ? below(random, frame.segment_count + 1) : 0;
  for (std::uint32_t i = 0; i < frame.segment_count; ++i) {
    firmware::Segment& segment = frame.segments[i];
    segment.id = any<std::uint32_t>(random);
    segment.duration = below(random, firmware::kMaxSegmentTicks + 1);
    segment.wait_for_index = random() % 4 == 0;
    segment.spindle_period = random() % 4 == 0 ? any<std::uint32_t>(random) : 0;
    if (random() % 4 == 0) segment.change = random_change(random);
    for (std::size_t axis = 0; axis < firmware::kAxisCount; ++axis) {
      const bool stands = i > 0 && random() % 2 == 0;
      segment.position[axis] =
          stands ? frame.segments[i - 1].position[axis] : any<std::int64_t>(random);
      segment.velocity[axis] =
          stands ? 0 : static_cast<std::int32_t>(any<std::uint32_t>(random) >> 3);
    }
  }
  return frame;
}

/// A step count that a board can have: 2^29 at the most, either way.
std::int64_t any_count(std::mt19937& random) {
  return std::int64_t{any<std::uint32_t>(random) >> 2U} - (std::int64_t{1} << 29U);
}
void fill_counts(firmware::PerAxis<std::int64_t>& counts, std::mt19937& random) {
  for (std::int64_t& count : counts) count = any_count(random);
}

firmware::Status random_status(std::mt19937& random) {
  firmware::Status status;
  const auto moment = [&] { return status.time - any<std::uint32_t>(random); };
  status.time = any<std::int64_t>(random) >> 2U;
  status.faults = any<std::uint16_t>(random);
  status.executing_id = any<std::uint32_t>(random);
  status.executing_elapsed = any<std::uint32_t>(random);
  status.executing_duration = any<std::uint32_t>(random);
  status.fifo_count = any<std::uint16_t>(random);
  status.fifo_free = any<std::uint16_t>(random);
  status.queued_time = any<std::int64_t>(random);
  status.moving = random() % 2 == 0;
  fill_counts(status.counts, random);
  status.inputs.home = any<std::uint8_t>(random);
  status.inputs.probe = random() % 2 == 0;
  status.inputs.ports = any<std::uint64_t>(random);
  for (auto& analog : status.inputs.analog) analog = any<std::uint32_t>(random);
  status.inputs.index_count = any<std::uint32_t>(random);
  status.inputs.index_time = moment();
  fill_counts(status.index_counts, random);
  status.inputs.alarm = any<std::uint8_t>(random);
  status.spindle_period = any<std::int64_t>(random);
  for (auto& latch : status.home_latch) {
    latch = {.armed = random() % 2 == 0, .caught = random() % 2 == 0};
    if (!latch.armed && !latch.caught) continue;
    latch.count = any_count(random);
    latch.time = moment();
  }
  if (random() % 2 == 0) {
    status.probe_latch.caught = true;
    fill_counts(status.probe_latch.counts, random);
    status.probe_latch.time = moment();
  }
  if (random() % 2 == 0) {
    status.estop_latch.count = 1U + any<std::uint32_t>(random) / 2;
    fill_counts(status.estop_latch.counts, random);
    status.estop_latch.time = moment();
  }
  status.path_stop = static_cast<firmware::PathStop>(random() % 3);
  status.time_scale = any<std::uint32_t>(random);
  status.outputs = random_outputs(random);
  for (auto& count : status.guard_counts) count = random() % 4 == 0 ? any<std::uint8_t>(random) : 0;
  return status;
}

/// What `put` writes, whole as a packet's body would be.
template <typename Put>
Bytes body_of(Put put) {
  Bytes memory(kMaxPacket - kHeaderSize - kCrcSize);
  ByteWriter body(memory);
  put(body);
  REQUIRE_FALSE(body.overflow());
  return {body.written().begin(), body.written().end()};
}
Bytes body_of(const firmware::HostFrame& frame) {
  return body_of([&](ByteWriter& body) { put_frame(body, frame); });
}
Bytes body_of(const firmware::Status& status) {
  return body_of([&](ByteWriter& body) { put_status(body, {}, status); });
}

bool read(const Bytes& bytes, firmware::HostFrame& frame) {
  ByteReader body(bytes);
  return get_frame(body, frame);
}
bool read(const Bytes& bytes, firmware::Status& status) {
  ByteReader body(bytes);
  StatusNumbers numbers;
  return get_status(body, numbers, status);
}

/// Every shorter and longer body is refused, and every damaged one either refused or read as
/// something that is written as it was read.
template <typename Message>
void require_strict(const Bytes& bytes, std::mt19937& random) {
  Message message;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    CHECK_FALSE(read(Bytes(bytes.begin(), bytes.begin() + static_cast<long>(size)), message));
  }
  Bytes longer = bytes;
  longer.push_back(0);
  CHECK_FALSE(read(longer, message));
  for (int i = 0; i < 200; ++i) {
    Bytes damaged = bytes;
    damaged[random() % damaged.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
    static_cast<void>(read(damaged, message));
  }
}

}  // namespace

TEST_CASE("The CRC is that of Ethernet", "[hal][LNK-9]") {
  // The check value that every catalogue of CRCs gives for CRC-32.
  const std::string digits = "123456789";
  CHECK(crc32(Bytes(digits.begin(), digits.end())) == 0xCBF43926);
  CHECK(crc32({}) == 0);
}

TEST_CASE("What is stuffed for a serial line comes out as it was, and holds no zero",
          "[hal][LNK-9]") {
  std::mt19937 random(1);
  for (const std::size_t size : {1U, 2U, 253U, 254U, 255U, 256U, 508U, 509U, 1400U}) {
    for (const unsigned zeros : {0U, 1U, 50U, 100U}) {
      CAPTURE(size, zeros);
      const Bytes packet = random_bytes(random, size, zeros);
      Bytes line(cobs_size(size));
      const std::size_t written = write_cobs(packet, line);
      REQUIRE(written <= line.size());
      CHECK(std::count(line.begin(), line.begin() + static_cast<long>(written), 0) == 1);
      CobsReader<1400> reader;
      std::size_t packets = 0;
      for (std::size_t i = 0; i < written; ++i) packets += reader.take(line[i]) ? 1U : 0U;
      REQUIRE(packets == 1);
      CHECK(Bytes(reader.packet().begin(), reader.packet().end()) == packet);
    }
  }
}

TEST_CASE("A serial line that lost or invented bytes is in step again with the next packet",
          "[hal][LNK-9]") {
  std::mt19937 random(2);
  CobsReader<1400> reader;
  for (int i = 0; i < 500; ++i) {
    const Bytes packet = random_bytes(random, 1 + random() % 1400, 5);
    Bytes line(cobs_size(packet.size()));
    line.resize(write_cobs(packet, line));
    Bytes bad = line;
    bad.resize(random() % bad.size());
    for (auto& byte : bad) byte ^= random() % 50 == 0 ? std::uint8_t{0x55} : std::uint8_t{0};
    for (const auto byte : bad) static_cast<void>(reader.take(byte));
    static_cast<void>(reader.take(0));
    bool complete = false;
    for (const auto byte : line) complete = reader.take(byte);
    REQUIRE(complete);
    REQUIRE(Bytes(reader.packet().begin(), reader.packet().end()) == packet);
  }
}

TEST_CASE("A frame of the most and largest segments fits a packet", "[hal][LNK-9]") {
  firmware::HostFrame frame;
  constexpr firmware::OutputChange kAll{.changed = 31, .port = 1, .pwm = 1};
  frame.has_outputs = frame.has_cut = true;
  frame.change = kAll;
  frame.segment_count = firmware::kSegmentsPerFrame;
  for (auto& segment : frame.segments) {
    segment.spindle_period = 1;
    segment.change = kAll;
    segment.velocity.fill(1);
  }
  Bytes memory(kMaxPacket);
  PacketWriter packet(memory, PacketType::frame, 1);
  put_numbers(packet.body(), {});
  put_frame(packet.body(), frame);
  CHECK_FALSE(packet.finish().empty());
}

TEST_CASE("Frames come out of their bytes as they went in", "[hal][LNK-9]") {
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    const firmware::HostFrame written = random_frame(random);
    const Bytes bytes = body_of(written);
    firmware::HostFrame frame;
    REQUIRE(read(bytes, frame));
    CHECK(body_of(frame) == bytes);
    CHECK(frame.change == written.change);
    for (std::uint32_t s = 0; s < frame.segment_count; ++s) {
      CHECK(frame.segments[s].change == written.segments[s].change);
    }
    if (i < 20) require_strict<firmware::HostFrame>(bytes, random);
  }
}

TEST_CASE("A change of outputs that no board has is refused", "[hal][LNK-9]") {
  using firmware::OutputChange;
  const OutputChange bad = GENERATE(
      OutputChange{.changed = OutputChange::kMist, .on = OutputChange::kFlood},
      OutputChange{.changed = OutputChange::kSpindlePwm,
                   .spindle_pwm = firmware::Outputs::kFullPwm + 1},
      OutputChange{.port = firmware::kPortCount + 1}, OutputChange{.pwm = firmware::kPwmCount + 1},
      OutputChange{.pwm = 1, .pwm_value = firmware::Outputs::kFullPwm + 1});
  firmware::HostFrame frame;
  frame.change = bad;
  firmware::HostFrame read_back;
  CHECK_FALSE(read(body_of(frame), read_back));
  frame.change = {};
  frame.segment_count = 1;
  frame.segments[0].change = bad;
  CHECK_FALSE(read(body_of(frame), read_back));
}

TEST_CASE("A status comes out of its bytes as it went in", "[hal][LNK-9]") {
  std::mt19937 random(4);
  for (int i = 0; i < 300; ++i) {
    const firmware::Status written = random_status(random);
    const Bytes bytes = body_of(written);
    firmware::Status status;
    REQUIRE(read(bytes, status));
    CHECK(body_of(status) == bytes);
    CHECK(status.counts == written.counts);
    CHECK(status.outputs == written.outputs);
    CHECK(status.inputs.alarm == written.inputs.alarm);
    CHECK(status.guard_counts == written.guard_counts);
    if (i < 20) require_strict<firmware::Status>(bytes, random);
  }
}

TEST_CASE("A setup comes out of its bytes as it went in", "[hal][LNK-9]") {
  std::mt19937 random(5);
  firmware::Setup written{.max_velocity = any<std::int64_t>(random),
                          .host_timeout = any<std::int64_t>(random),
                          .index_timeout = any<std::int64_t>(random),
                          .drives_off_on_fault = false};
  for (auto& limit : written.max_acceleration) limit = any<std::int64_t>(random);
  written.pulse_width = 25;
  written.direction_setup = 50;
  written.direction_hold = 75;
  written.step_inverted = 0b1;
  written.guards[0] = {0xFF, 0x81, firmware::GuardAction::quick_stop};
  written.guards[23] = {1, 0, firmware::GuardAction::warning};
  written.direction_inverted = 0b100;
  const Bytes bytes = body_of([&](ByteWriter& body) { put_setup(body, written); });
  firmware::Setup setup;
  ByteReader body(bytes);
  REQUIRE(get_setup(body, setup));
  CHECK(body_of([&](ByteWriter& again) { put_setup(again, setup); }) == bytes);
  CHECK(setup.max_acceleration == written.max_acceleration);
  CHECK(setup.guards == written.guards);
  Bytes strange = bytes;
  strange.back() = 4;  // an action that there is not
  ByteReader again(strange);
  CHECK_FALSE(get_setup(again, setup));
  CHECK(setup.pulse_width == 25);
  CHECK(setup.direction_inverted == 0b100);
  ByteReader shorter(std::span<const std::uint8_t>(bytes).first(bytes.size() - 1));
  CHECK_FALSE(get_setup(shorter, setup));
}

TEST_CASE("A velocity that no board can make stays one", "[hal][LNK-9]") {
  firmware::HostFrame frame;
  frame.segment_count = 1;
  frame.segments[0].velocity[0] = std::numeric_limits<std::int64_t>::max();
  firmware::HostFrame read_back;
  REQUIRE(read(body_of(frame), read_back));
  CHECK(read_back.segments[0].velocity[0] > firmware::kTopVelocity);
}

TEST_CASE("The least rate of a serial line passes the longest status 500 times a second",
          "[hal][LNK-1][LNK-9]") {
  firmware::Status status;
  CHECK(body_of(status).size() < kMaxStatus);
  for (firmware::HomeLatch& latch : status.home_latch) latch = {.armed = true};
  status.probe_latch.armed = true;
  status.estop_latch.count = 1;
  status.guard_counts.fill(1);
  CHECK(body_of(status).size() == kMaxStatus);
  // With magic number, version, type, session and CRC, and what stuffing adds at most.
  constexpr std::size_t kSize = cobs_size(8 + kMaxStatus + 4);
  CHECK(kSize == 371);
  constexpr unsigned kBits = 10;  // of a byte: start, 8, stop
  for (const unsigned rate : SerialChannel::kRates) CHECK(500 * kBits * kSize <= rate);
}

TEST_CASE("A packet with any wrong bit is none", "[hal][LNK-9]") {
  Bytes memory(kMaxPacket);
  PacketWriter writer(memory, PacketType::poll, 7);
  put_numbers(writer.body(), {.sequence = 0, .stops = 3, .stamp = 9});
  const auto whole = writer.finish();
  REQUIRE(open_packet(whole));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes damaged(whole.begin(), whole.end());
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    CHECK_FALSE(open_packet(damaged));
  }
  CHECK_FALSE(open_packet({}));
  CHECK_FALSE(open_packet(Bytes(kMaxPacket + 1)));
}
