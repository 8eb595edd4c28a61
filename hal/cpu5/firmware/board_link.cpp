#include "hal/cpu5/firmware/board_link.h"

namespace cnc::hal::cpu5::firmware {

using wire::ByteReader;
using wire::FrameNumbers;
using wire::PacketType;
using wire::PacketWriter;
using wire::RefusalReason;

namespace {

/// A host that has been silent for so long may be replaced by another.
constexpr Ticks kPatience = kTicksPerSecond;

std::span<const std::uint8_t> refuse(std::span<std::uint8_t> memory, std::uint32_t session,
                                     RefusalReason why, std::uint32_t boot) {
  PacketWriter packet(memory, PacketType::refusal, session);
  wire::put_refusal(packet.body(), {.reason = why, .boot = boot});
  return packet.finish();
}

}  // namespace

std::span<const std::uint8_t> BoardLink::answer(std::span<const std::uint8_t> packet,
                                                std::span<std::uint8_t> memory) {
  auto received = wire::open_packet(packet);
  if (!received) return {};
  const auto [version, type, session] = received->header;
  ByteReader& body = received->body;
  const auto refused = [&](RefusalReason why) { return refuse(memory, session, why, name_.boot); };

  if (version != wire::kVersion) {
    if (type != PacketType::hello) return {};
    return refused(RefusalReason::other_version);
  }
  if (type == PacketType::identify) {
    PacketWriter identity_packet(memory, PacketType::identity, session);
    wire::put_identity(identity_packet.body(), identity());
    return identity_packet.finish();
  }
  if (type == PacketType::hello) {
    RefusalReason why{};
    if (!takes_session(session, body, why)) return refused(why);
    PacketWriter welcome(memory, PacketType::welcome, session_);
    wire::put_identity(welcome.body(), identity());
    return welcome.finish();
  }
  if (type != PacketType::frame && type != PacketType::poll && type != PacketType::bye) return {};
  if (session == 0 || session != session_) return refused(RefusalReason::no_session);

  core_.host_alive();
  heard_ = core_.time();
  if (type == PacketType::bye) {
    core_.host_left();
    session_ = 0;
    return {};
  }
  const FrameNumbers numbers = wire::get_frame_numbers(body);
  if (body.bad()) return refused(RefusalReason::not_understood);
  take_stop(numbers.stops);
  if (type == PacketType::frame && !take_frame(numbers, body)) {
    return refused(RefusalReason::not_understood);
  }
  PacketWriter status(memory, PacketType::status, session_);
  wire::put_status(status.body(), numbers_of_answer(numbers.stamp), core_.status());
  return status.finish();
}

// --- sessions ------------------------------------------------------------------------------------

/// A greeting that comes again is welcomed again and changes nothing.
bool BoardLink::takes_session(std::uint32_t session, ByteReader& body, RefusalReason& why) {
  Setup setup;
  if (session == 0 || !wire::get_setup(body, setup)) {
    why = RefusalReason::not_understood;
    return false;
  }
  if (session == session_) return true;
  if (core_.moving() || (in_session() && core_.time() - heard_ < kPatience)) {
    why = RefusalReason::busy;
    return false;
  }
  if (!core_.set_up(setup)) {
    why = RefusalReason::bad_setup;
    return false;
  }
  begin_session(session);
  return true;
}

/// The setup has emptied the FIFO. Nothing that an earlier host had asked for goes on, but drives
/// that are on stay on.
void BoardLink::begin_session(std::uint32_t session) {
  session_ = session;
  executed_ = answers_ = stops_ = 0;
  for (WaitingFrame& waiting : waiting_) waiting.here = false;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) core_.disarm_latch(axis);
  core_.disarm_probe();
  core_.set_outputs({.drives_enabled = core_.status().outputs.drives_enabled});
  core_.host_alive();
  heard_ = core_.time();
}

wire::Identity BoardLink::identity() const {
  constexpr std::int64_t kTopFrequency = kTopVelocity * kTicksPerSecond / kOneStep;
  return {.serial = name_.serial,
          .boot = name_.boot,
          .in_session = in_session(),
          .name = name_.name,
          .max_step_frequency = static_cast<std::uint32_t>(kTopFrequency),
          .fifo_capacity = static_cast<std::uint16_t>(kFifoCapacity),
          .axes = static_cast<std::uint8_t>(kAxisCount),
          .window = static_cast<std::uint8_t>(kFrameWindow)};
}

// --- frames --------------------------------------------------------------------------------------

/// What was sent before it and comes after it moves and switches nothing any more.
void BoardLink::take_stop(std::uint32_t stops) {
  if (!is_newer(stops, stops_)) return;
  stops_ = stops;
  core_.quick_stop();
}

bool BoardLink::take_frame(const FrameNumbers& numbers, ByteReader& body) {
  const std::uint32_t ahead = numbers.sequence - executed_;
  if (ahead == 0 || ahead > kFrameWindow) return true;
  WaitingFrame& place = waiting_[numbers.sequence % kFrameWindow];
  if (place.here) return true;
  if (!wire::get_frame(body, place.frame)) return false;
  place.stops = numbers.stops;
  place.here = true;
  execute_in_order();
  return true;
}

void BoardLink::execute_in_order() {
  while (group_is_here()) {
    bool goes_on = true;
    while (goes_on) {
      WaitingFrame& next = next_frame();
      next.here = false;
      ++executed_;
      if (next.stops != stops_) next.frame.drop_path_and_outputs();
      execute(next.frame, core_);
      goes_on = next.frame.with_next && next_frame().here;
    }
  }
}

/// The next frame, and all that it has to be executed with. More than the window holds never come.
bool BoardLink::group_is_here() const {
  for (std::uint32_t i = 1; i <= kFrameWindow; ++i) {
    const WaitingFrame& waiting = waiting_[(executed_ + i) % kFrameWindow];
    if (!waiting.here) return false;
    if (!waiting.frame.with_next) return true;
  }
  return true;
}

wire::StatusNumbers BoardLink::numbers_of_answer(std::uint32_t stamp) {
  std::uint32_t waiting = 0;
  for (std::uint32_t i = 0; i + 2 <= kFrameWindow; ++i) {
    const bool here = waiting_[(executed_ + 2 + i) % kFrameWindow].here;
    waiting |= (here ? std::uint32_t{1} : 0) << i;
  }
  return {.answer = ++answers_, .executed = executed_, .waiting = waiting, .stamp = stamp};
}

}  // namespace cnc::hal::cpu5::firmware
