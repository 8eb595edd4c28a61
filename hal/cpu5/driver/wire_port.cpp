#include "hal/cpu5/driver/wire_port.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/core.h>
#include <random>
#include <thread>

#include "hal/cpu5/wire/crc32.h"

namespace cnc::hal::cpu5 {

using wire::ByteReader;
using wire::ByteWriter;
using wire::PacketType;
using wire::PacketWriter;
using wire::RefusalReason;
using Kind = LinkObstacle::Kind;

namespace {

constexpr double kGreetingInterval = 0.1;                 // s
constexpr std::chrono::milliseconds kOpenPatience{1000};  // of open()
constexpr std::chrono::milliseconds kOpenPause{2};        // between two looks

/// A frame is sent again after the smoothed round trip and four times its mean deviation (Jacobson,
/// "Congestion Avoidance and Control", 1988), twice as long after each attempt.
constexpr double kTripGain = 1.0 / 8.0;
constexpr double kDeviationGain = 1.0 / 4.0;
constexpr double kDeviations = 4.0;
constexpr double kShortestWait = 0.002;  // s
constexpr double kLongestWait = 0.1;

/// Greetings without an answer until the board counts as silent, and until the channel is asked to
/// look elsewhere.
constexpr unsigned kSilentGreetings = 10;
constexpr unsigned kVainGreetings = 20;
/// Welcomes without a status until the board counts as one that has none.
constexpr unsigned kVainWelcomes = 3;

constexpr double kStampsPerSecond = 1e6;

LinkObstacle obstacle_of(const wire::Refusal& refusal) {
  switch (refusal.reason) {
    case RefusalReason::other_version:
      return {Kind::other_version, refusal.lowest_version, refusal.highest_version, wire::kVersion};
    case RefusalReason::busy:
      return {Kind::busy};
    case RefusalReason::bad_setup:
      return {Kind::bad_setup};
    case RefusalReason::no_session:
    case RefusalReason::not_understood:
      break;
  }
  return {Kind::not_understood};
}

std::uint32_t random_session() {
  std::random_device random;
  return random() | 1U;
}

/// The next of a sequence that does not repeat soon (xorshift; Marsaglia, J. Stat. Softw. 8, 2003).
std::uint32_t session_after(std::uint32_t session) {
  session ^= session << 13;
  session ^= session >> 17;
  session ^= session << 5;
  return session;
}

}  // namespace

WirePort::WirePort(std::unique_ptr<PacketChannel> channel, const WireSettings& settings)
    : channel_(std::move(channel)), settings_(settings), session_(random_session()) {}

WirePort::~WirePort() { WirePort::close(); }

// --- greeting ------------------------------------------------------------------------------------

Result<void> WirePort::begin(const firmware::Setup& setup) {
  if (state_ == State::running) close();
  setup_ = setup;
  state_ = State::greeting;
  greetings_in_vain_ = welcomes_in_vain_ = 0;
  answer_.obstacle = {};
  return channel_->open();
}

Result<wire::Identity> WirePort::open(const firmware::Setup& setup) {
  if (auto begun = begin(setup); !begun) return std::unexpected(begun.error());
  const auto until = std::chrono::steady_clock::now() + kOpenPatience;
  auto next_greeting = std::chrono::steady_clock::time_point{};
  while (std::chrono::steady_clock::now() < until) {
    if (std::chrono::steady_clock::now() >= next_greeting) {
      state_ == State::running ? poll() : greet();
      next_greeting = std::chrono::steady_clock::now() +
                      std::chrono::milliseconds(std::lround(1e3 * kGreetingInterval));
    }
    receive_all();
    if (answer_.connected) return answer_.identity;
    if (answer_.obstacle.kind != Kind::none && answer_.obstacle.kind != Kind::busy) break;
    std::this_thread::sleep_for(kOpenPause);
  }
  if (answer_.obstacle.kind == Kind::none)
    answer_.obstacle.kind = welcomes_in_vain_ > 0 ? Kind::no_status : Kind::silent;
  return std::unexpected(
      error_of(answer_.obstacle, fmt::format("The controller board at {}", channel_->name())));
}

void WirePort::close() {
  if (state_ == State::running) {
    std::array<std::uint8_t, wire::kHeaderSize + wire::kCrcSize> memory;
    PacketWriter bye(memory, PacketType::bye, session_);
    channel_->send(bye.finish());
    lose_link();
  }
  state_ = State::closed;
  channel_->close();
}

void WirePort::greet() {
  greeted_at_ = now_;
  if (channel_->is_open()) note_greeting();
  std::array<std::uint8_t, wire::kMaxPacket> memory;
  PacketWriter hello(memory, PacketType::hello, session_);
  wire::put_setup(hello.body(), setup_);
  channel_->send(hello.finish());
  ++answer_.packets.sent;
}

void WirePort::note_greeting() {
  ++greetings_in_vain_;
  if (greetings_in_vain_ % kSilentGreetings == 0) answer_.obstacle = {Kind::silent};
  if (greetings_in_vain_ % kVainGreetings == 0) channel_->look_elsewhere();
}

bool WirePort::take_welcome(ByteReader& body) {
  wire::Identity identity;
  if (state_ != State::greeting || !wire::get_identity(body, identity)) return false;
  greetings_in_vain_ = 0;
  LinkObstacle unsuitable;
  if (identity.window == 0) unsuitable = {Kind::not_understood};
  if (identity.axes != firmware::kAxisCount)
    unsuitable = {Kind::other_axes, identity.axes, identity.axes, firmware::kAxisCount};
  if (++welcomes_in_vain_ >= kVainWelcomes) answer_.obstacle = {Kind::no_status};
  if (unsuitable.kind != Kind::none) {
    answer_.obstacle = unsuitable;
    return false;
  }
  answer_.identity = identity;
  window_ = std::min<std::uint32_t>(identity.window, kWindow);
  answer_.counts_lost = boot_known_ && identity.boot != boot_;
  state_ = State::running;
  note_answer();
  sequence_ = executed_ = waiting_ = newest_answer_ = stops_ = 0;
  smoothed_trip_ = trip_deviation_ = 0.0;
  answer_.status = {};
  poll();
  return true;
}

/// A board that does not know the session any more has been reset; one that does not understand is
/// of no use either.
bool WirePort::take_refusal(ByteReader& body) {
  wire::Refusal refusal;
  if (!wire::get_refusal(body, refusal)) return false;
  if (state_ == State::running) {
    lose_link();
  } else if (state_ == State::greeting) {
    greetings_in_vain_ = 0;
    // A board that gives no status is busy with this host's last session for a second.
    const bool explains_nothing =
        refusal.reason == RefusalReason::busy && answer_.obstacle.kind == Kind::no_status;
    if (!explains_nothing) answer_.obstacle = obstacle_of(refusal);
  }
  return true;
}

/// What was on its way is void; for whoever waits for it, it is done.
void WirePort::lose_link() {
  state_ = State::greeting;
  session_ = session_after(session_);
  greetings_in_vain_ = 0;
  answer_.connected = false;
  answer_.frames_done = frames_sent_;
  executed_ = sequence_;
}

// --- frames --------------------------------------------------------------------------------------

std::uint32_t WirePort::room() const {
  return state_ == State::running ? window_ - on_their_way() : 0;
}

void WirePort::send(const firmware::HostFrame& frame) {
  Sent& sent = frames_[++sequence_ % kWindow];
  ++frames_sent_;
  PacketWriter packet(sent.memory, PacketType::frame, session_);
  wire::put_numbers(packet.body(), {.sequence = sequence_, .stops = stops_});
  wire::put_frame(packet.body(), frame);
  sent.size = packet.finish().size();
  sent.times = 0;
  send_again(sent);
  if (on_their_way() == window_) receive_all();  // a board in this process has answered already
}

void WirePort::send_again(Sent& frame) {
  const auto packet = std::span(frame.memory).first(frame.size);
  ByteWriter(packet.subspan(wire::kStampPlace)).put(stamp());
  const auto content = packet.first(frame.size - wire::kCrcSize);
  ByteWriter(packet.last(wire::kCrcSize)).put(wire::crc32(content));
  note_asking();
  channel_->send(packet);
  frame.at = now_;
  if (frame.times++ > 0) ++answer_.packets.resent;
  ++answer_.packets.sent;
}

void WirePort::quick_stop() {
  ++stops_;
  if (state_ == State::running) poll();
}

void WirePort::poll() {
  std::array<std::uint8_t, wire::kHeaderSize + sizeof(wire::FrameNumbers) + wire::kCrcSize> memory;
  PacketWriter packet(memory, PacketType::poll, session_);
  wire::put_numbers(packet.body(), {.sequence = 0, .stops = stops_, .stamp = stamp()});
  note_asking();
  channel_->send(packet.finish());
  ++answer_.packets.sent;
}

void WirePort::note_answer() {
  asked_ = false;
  unanswered_since_.reset();
}

void WirePort::note_asking() {
  sent_at_ = now_;
  asked_ = true;
}

/// A frame behind which another one has arrived is taken for lost after a round trip.
void WirePort::send_what_is_due() {
  const double wait = smoothed_trip_ + kDeviations * trip_deviation_;
  for (std::uint32_t number = executed_ + 1; number != sequence_ + 1; ++number) {
    const std::uint32_t ahead = number - executed_;
    if (ahead >= 2 && ((waiting_ >> (ahead - 2)) & 1U) != 0) continue;
    Sent& frame = frames_[number % kWindow];
    const bool overtaken = ahead >= 1 && (waiting_ >> (ahead - 1)) != 0;
    const double patience =
        std::clamp(overtaken ? smoothed_trip_ + trip_deviation_
                             : std::ldexp(wait, static_cast<int>(std::min(frame.times, 6U)) - 1),
                   kShortestWait, kLongestWait);
    if (now_ - frame.at > patience) send_again(frame);
  }
  if (sent_at_ != now_) poll();
}

// --- answers -------------------------------------------------------------------------------------

void WirePort::receive(double now) {
  now_ = now;
  channel_->set_time(now);
  if (state_ == State::closed) return;
  receive_all();
  if (state_ != State::running || !asked_) return;
  if (!unanswered_since_) unanswered_since_ = now_;
  if (now_ - *unanswered_since_ > settings_.silence) lose_link();
}

const BoardAnswer& WirePort::exchange() {
  if (state_ == State::running) send_what_is_due();
  if (state_ == State::greeting && now_ - greeted_at_ >= kGreetingInterval) greet();
  if (state_ != State::closed) receive_all();
  return answer_;
}

void WirePort::receive_all() {
  for (auto packet = channel_->receive(); !packet.empty(); packet = channel_->receive()) {
    take(packet);
  }
}

void WirePort::take(std::span<const std::uint8_t> packet) {
  auto received = wire::open_packet(packet);
  if (!received) {
    ++answer_.packets.corrupted;
    return;
  }
  const bool ours =
      received->header.version == wire::kVersion && received->header.session == session_;
  const bool brought_something = ours && take(received->header.type, received->body);
  ++(brought_something ? answer_.packets.answered : answer_.packets.passed_over);
}

bool WirePort::take(PacketType type, ByteReader& body) {
  switch (type) {
    case PacketType::welcome:
      return take_welcome(body);
    case PacketType::refusal:
      return take_refusal(body);
    case PacketType::status:
      return take_status(body);
    default:
      return false;
  }
}

bool WirePort::take_status(ByteReader& body) {
  wire::StatusNumbers numbers;
  const bool taken = state_ == State::running && wire::get_status(body, numbers, status_) &&
                     is_newer(numbers.answer, newest_answer_) &&
                     numbers.executed - executed_ <= on_their_way();
  if (!taken) return false;
  if (!answer_.connected) {
    // Not before: whoever uses this link has to be told that the counts are lost.
    boot_ = answer_.identity.boot;
    boot_known_ = true;
    answer_.connected = true;
    answer_.obstacle = {};
    welcomes_in_vain_ = 0;
    ++answer_.greetings;
  }
  newest_answer_ = numbers.answer;
  executed_ = numbers.executed;
  waiting_ = numbers.waiting;
  note_answer();
  answer_.frames_done = frames_sent_ - on_their_way();
  answer_.status = status_;
  take_round_trip(numbers.stamp);
  return true;
}

void WirePort::take_round_trip(std::uint32_t stamp_then) {
  const double trip = (stamp() - stamp_then) / kStampsPerSecond;
  if (trip > settings_.silence) return;  // it went round, or the board made it up
  answer_.round_trip = trip;
  const bool first = smoothed_trip_ == 0.0 && trip_deviation_ == 0.0;
  const double error = trip - smoothed_trip_;
  smoothed_trip_ = first ? trip : smoothed_trip_ + kTripGain * error;
  trip_deviation_ =
      first ? 0.5 * trip : trip_deviation_ + kDeviationGain * (std::abs(error) - trip_deviation_);
}

std::uint32_t WirePort::stamp() const {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(now_ * kStampsPerSecond));
}

}  // namespace cnc::hal::cpu5
