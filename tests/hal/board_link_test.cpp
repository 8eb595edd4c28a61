// The board's side of the wire: sessions, and frames in their order whatever the line does.
#include "hal/cpu5/firmware/board_link.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "hal/cpu5/wire/crc32.h"
#include "tests/hal/firmware_support.h"

using namespace cnc::hal::cpu5;
using namespace cnc::hal::cpu5::firmware;
using wire::PacketType;
using wire::RefusalReason;

namespace {

using Packet = std::vector<std::uint8_t>;

template <typename Put>
Packet packet_of(PacketType type, std::uint32_t session, Put put) {
  Packet memory(wire::kMaxPacket);
  wire::PacketWriter writer(memory, type, session);
  put(writer.body());
  const auto whole = writer.finish();
  return {whole.begin(), whole.end()};
}

Packet hello(std::uint32_t session, const Setup& setup = kFastBoard) {
  return packet_of(PacketType::hello, session,
                   [&](wire::ByteWriter& body) { wire::put_setup(body, setup); });
}

Packet poll(std::uint32_t session, std::uint32_t stops = 0) {
  return packet_of(PacketType::poll, session,
                   [&](wire::ByteWriter& body) { wire::put_numbers(body, {.stops = stops}); });
}

Packet frame_packet(std::uint32_t session, std::uint32_t sequence, const HostFrame& frame,
                    std::uint32_t stops = 0) {
  return packet_of(PacketType::frame, session, [&](wire::ByteWriter& body) {
    wire::put_numbers(body, {.sequence = sequence, .stops = stops});
    wire::put_frame(body, frame);
  });
}

/// The n-th of segments of one step each.
Packet segment_packet(std::uint32_t sequence, std::uint32_t stops = 0) {
  HostFrame frame;
  frame.segment_count = 1;
  frame.segments[0] = x_segment(sequence, 0.01, sequence);
  return frame_packet(1, sequence, frame, stops);
}

struct Rig {
  WatchedBoard board;
  Core core{board};
  BoardLink link{core, {.serial = 42, .boot = 7, .name = {}}};
  Packet memory = Packet(wire::kMaxPacket);

  std::optional<wire::ReceivedPacket> answer(const Packet& packet) {
    return wire::open_packet(link.answer(packet, memory));
  }
  PacketType type_of_answer(const Packet& packet) {
    const auto received = answer(packet);
    REQUIRE(received);
    return received->header.type;
  }
  std::pair<wire::StatusNumbers, Status> status(const Packet& packet) {
    auto received = answer(packet);
    REQUIRE(received);
    REQUIRE(received->header.type == PacketType::status);
    std::pair<wire::StatusNumbers, Status> result;
    REQUIRE(wire::get_status(received->body, result.first, result.second));
    return result;
  }
  RefusalReason refusal(const Packet& packet) {
    auto received = answer(packet);
    REQUIRE(received);
    REQUIRE(received->header.type == PacketType::refusal);
    wire::Refusal refusal;
    REQUIRE(wire::get_refusal(received->body, refusal));
    CHECK(refusal.boot == 7);
    return refusal.reason;
  }
};

}  // namespace

TEST_CASE("Whoever asks is told who the board is", "[hal][LNK-9][LNK-1]") {
  Rig rig;
  auto received = rig.answer(packet_of(PacketType::identify, 5, [](auto&) {}));
  REQUIRE(received);
  CHECK(received->header.session == 5);
  wire::Identity identity;
  REQUIRE(wire::get_identity(received->body, identity));
  CHECK(identity.serial == 42);
  CHECK(identity.fifo_capacity == kFifoCapacity);
  CHECK_FALSE(identity.in_session);
}

TEST_CASE("A session begins with a greeting that is understood", "[hal][LNK-9]") {
  Rig rig;
  CHECK(rig.refusal(poll(1)) == RefusalReason::no_session);
  CHECK(rig.refusal(hello(0)) == RefusalReason::not_understood);
  CHECK(rig.refusal(hello(1, {.max_velocity = 0})) == RefusalReason::bad_setup);
  CHECK(rig.refusal(packet_of(PacketType::hello, 1, [](auto&) {})) ==
        RefusalReason::not_understood);
  CHECK(rig.type_of_answer(hello(1)) == PacketType::welcome);
  CHECK(rig.type_of_answer(hello(1)) == PacketType::welcome);  // it was doubled, or its answer lost
  CHECK(rig.status(poll(1)).first.executed == 0);
  CHECK(rig.refusal(poll(2)) == RefusalReason::no_session);
}

TEST_CASE("A setup whose pulses and pauses do not fit the highest frequency is refused",
          "[hal][LNK-9]") {
  Rig rig;
  // 400 kHz: a step in 25 ticks.
  Setup setup{.max_velocity = velocity_of_frequency(400'000)};
  setup.pulse_width = 0;
  CHECK(rig.refusal(hello(1, setup)) == RefusalReason::bad_setup);
  setup.pulse_width = 13;
  CHECK(rig.refusal(hello(1, setup)) == RefusalReason::bad_setup);
  setup.pulse_width = 12;
  CHECK(rig.type_of_answer(hello(1, setup)) == PacketType::welcome);
}

TEST_CASE("Another version is refused with those that the board speaks", "[hal][LNK-9]") {
  Rig rig;
  Packet packet(wire::kMaxPacket);
  wire::ByteWriter bytes(packet);
  bytes.put(wire::kMagic);
  bytes.put(static_cast<std::uint8_t>(wire::kVersion + 1));
  bytes.put(static_cast<std::uint8_t>(PacketType::hello));
  bytes.put(std::uint32_t{1});
  packet.resize(bytes.size());
  const std::uint32_t crc = wire::crc32(packet);
  for (int i = 0; i < 4; ++i) packet.push_back(static_cast<std::uint8_t>(crc >> (8 * i)));
  CHECK(rig.refusal(packet) == RefusalReason::other_version);
}

TEST_CASE("A board with a host has no ear for another, until that one is silent or gone",
          "[hal][LNK-9]") {
  Rig rig;
  REQUIRE(rig.type_of_answer(hello(1)) == PacketType::welcome);
  CHECK(rig.refusal(hello(2)) == RefusalReason::busy);
  SECTION("gone") {
    CHECK_FALSE(rig.answer(packet_of(PacketType::bye, 1, [](auto&) {})));
    CHECK(rig.type_of_answer(hello(2)) == PacketType::welcome);
  }
  SECTION("silent") {
    rig.core.advance(ticks(1.1));
    CHECK(rig.type_of_answer(hello(2)) == PacketType::welcome);
    CHECK(rig.refusal(poll(1)) == RefusalReason::no_session);
  }
  SECTION("silent, but the machine moves") {
    HostFrame frame;
    frame.segment_count = 13;
    for (std::uint32_t i = 0; i < 13; ++i)
      frame.segments[i] = x_segment(i + 1, 0.1, 10.0 * (i + 1));
    rig.status(frame_packet(1, 1, frame));
    rig.core.advance(ticks(1.2));
    CHECK(rig.refusal(hello(2)) == RefusalReason::busy);
    rig.core.advance(ticks(0.2));
    CHECK(rig.type_of_answer(hello(2)) == PacketType::welcome);
  }
}

TEST_CASE("Frames are executed once and in order, whatever order they come in", "[hal][LNK-9]") {
  std::vector<std::uint32_t> order{1, 2, 3, 4, 5, 6, 7};
  do {
    Rig rig;
    REQUIRE(rig.type_of_answer(hello(1)) == PacketType::welcome);
    for (const std::uint32_t sequence : order) {
      rig.status(segment_packet(sequence));
      rig.status(segment_packet(sequence));
    }
    const auto [numbers, status] = rig.status(poll(1));
    CHECK(numbers.executed == 7);
    CHECK(numbers.waiting == 0);
    CHECK(status.faults == 0);
    REQUIRE(status.fifo_count == 7);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("A status says which frames have arrived", "[hal][LNK-9]") {
  Rig rig;
  rig.answer(hello(1));
  rig.status(segment_packet(1));
  rig.status(segment_packet(3));
  const auto numbers = rig.status(segment_packet(6)).first;
  CHECK(numbers.executed == 1);
  CHECK(numbers.waiting == 0b1001);  // 3 and 6 wait for 2
  CHECK(rig.status(segment_packet(2)).first.executed == 3);
  // Beyond the window nothing is kept.
  CHECK(rig.status(segment_packet(3 + kFrameWindow + 1)).first.waiting == 0b010);
}

TEST_CASE("A quick stop does not wait for frames that are missing, and voids those before it",
          "[hal][LNK-9][LNK-8]") {
  Rig rig;
  rig.answer(hello(1));
  rig.status(segment_packet(1));
  rig.status(segment_packet(3));  // 2 is on its way
  const Status stopped = rig.status(poll(1, 1)).second;
  CHECK(stopped.fifo_count == 0);
  rig.status(segment_packet(2));  // and comes: both were asked for before the stop
  CHECK(rig.status(poll(1, 1)).first.executed == 3);
  CHECK(rig.status(poll(1, 1)).second.fifo_count == 0);
  HostFrame frame;
  frame.segment_count = 1;
  frame.segments[0] = x_segment(9, 0.01, 1);
  CHECK(rig.status(frame_packet(1, 4, frame, 1)).second.fifo_count == 1);
}

namespace {

/// One that is not to be executed before the next.
Packet packet_with_next(std::uint32_t sequence, std::uint32_t stops = 0) {
  HostFrame frame;
  frame.with_next = true;
  frame.segment_count = 1;
  frame.segments[0] = x_segment(sequence, 0.01, sequence);
  return frame_packet(1, sequence, frame, stops);
}

}  // namespace

TEST_CASE("Frames that go together are executed when the last of them is here",
          "[hal][LNK-9][LNK-8]") {
  Rig rig;
  rig.answer(hello(1));
  // In their order, or with the last one first.
  const bool in_order = GENERATE(true, false);
  rig.status(in_order ? packet_with_next(1) : segment_packet(3));
  rig.status(packet_with_next(in_order ? 2 : 1));
  const auto [numbers, before] = rig.status(poll(1));
  CHECK(numbers.executed == 0);
  CHECK(numbers.waiting == (in_order ? 0b01U : 0b10U));
  CHECK(before.fifo_count == 0);
  rig.core.advance(ticks(0.5));
  CHECK(rig.status(poll(1)).second.fifo_count == 0);
  const auto [all, after] = rig.status(in_order ? segment_packet(3) : packet_with_next(2));
  CHECK(all.executed == 3);
  CHECK(after.fifo_count == 3);
}

TEST_CASE("A quick stop does not wait for the last of the frames that go together",
          "[hal][LNK-9][LNK-8][safety]") {
  Rig rig;
  rig.answer(hello(1));
  rig.status(segment_packet(1));
  rig.status(packet_with_next(2));
  CHECK(rig.status(poll(1)).second.fifo_count == 1);
  CHECK(rig.status(poll(1, 1)).second.fifo_count == 0);
  // The host's next frame ends the waiting; nothing of the path comes back with it.
  CHECK(rig.status(frame_packet(1, 3, HostFrame{}, 1)).first.executed == 3);
  CHECK(rig.status(poll(1, 1)).second.fifo_count == 0);
}

TEST_CASE("Frames that go together and fill the window do not wait for one that cannot come",
          "[hal][LNK-9]") {
  Rig rig;
  rig.answer(hello(1));
  for (std::uint32_t i = 1; i < kFrameWindow; ++i)
    CHECK(rig.status(packet_with_next(i)).first.executed == 0);
  CHECK(rig.status(packet_with_next(kFrameWindow)).first.executed == kFrameWindow);
}

TEST_CASE("A frame that makes no sense is refused and never executed", "[hal][LNK-9]") {
  Rig rig;
  rig.answer(hello(1));
  const Packet bad = packet_of(PacketType::frame, 1, [](wire::ByteWriter& body) {
    wire::put_numbers(body, {.sequence = 1});
    for (int i = 0; i < 30; ++i) body.put(std::uint8_t{0xEE});
  });
  CHECK(rig.refusal(bad) == RefusalReason::not_understood);
  CHECK(rig.status(poll(1)).first.executed == 0);
  CHECK(rig.status(poll(1)).second.faults == 0);
}

TEST_CASE("A new session finds an empty FIFO, safe outputs and nothing armed", "[hal][LNK-9]") {
  Rig rig;
  rig.answer(hello(1));
  HostFrame frame;
  frame.has_outputs = true;
  frame.outputs = {.drives_enabled = true, .spindle_on = true};
  frame.latch[2] = LatchRequest::arm_activate;
  frame.probe = ProbeRequest::arm;
  rig.status(frame_packet(1, 1, frame));
  CHECK(rig.board.last_outputs.spindle_on);
  rig.core.advance(ticks(1.1));
  REQUIRE(rig.type_of_answer(hello(2)) == PacketType::welcome);
  const Status status = rig.status(poll(2)).second;
  CHECK(status.outputs == Outputs{.drives_enabled = true});
  CHECK_FALSE(status.home_latch[2].armed);
  CHECK_FALSE(status.probe_latch.armed);
}
