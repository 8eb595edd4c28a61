// A board behind a line that may lose, delay, double, reorder or damage packets.
//
// Frames are numbered and kept until the board has answered that it has executed them; up to a
// window of them are on their way at once. One is sent again when its answer is overdue by what
// round trips have taken lately, or when later ones have come through. Every exchange sends
// something, so that the board hears the host and the host the board.
//
// A board that is silent for longer than the time-out, or does not know the session (it was reset,
// or another host has it), is lost: what is on its way is void, and the port greets until it is
// welcome again. Why it is not is in BoardAnswer::obstacle.
#pragma once

#include <array>
#include <memory>

#include "hal/cpu5/driver/board_port.h"
#include "hal/cpu5/driver/packet_channel.h"

namespace cnc::hal::cpu5 {

struct WireSettings {
  double silence = 0.25;  ///< s after which the board counts as lost
};

class WirePort : public BoardPort {
 public:
  WirePort(std::unique_ptr<PacketChannel> channel, const WireSettings& settings);
  WirePort(const WirePort&) = delete;
  WirePort& operator=(const WirePort&) = delete;
  /// Says goodbye: the board is free for the next host at once.
  ~WirePort() override;

  /// The first half of open(): exchange() will greet the board, also when this fails.
  Result<void> begin(const firmware::Setup& setup);
  Result<wire::Identity> open(const firmware::Setup& setup) override;
  void close() override;
  [[nodiscard]] std::uint32_t room() const override;
  void send(const firmware::HostFrame& frame) override;
  [[nodiscard]] std::uint64_t frames_sent() const override { return frames_sent_; }
  void quick_stop() override;
  void receive(double now) override;
  const BoardAnswer& exchange() override;

 private:
  static constexpr std::uint32_t kWindow = 32;

  enum class State : std::uint8_t { closed, greeting, running };

  /// A frame that is not known to have been executed.
  struct Sent {
    std::array<std::uint8_t, wire::kMaxPacket> memory;
    std::size_t size = 0;
    double at = 0.0;  ///< when it was last sent
    std::uint32_t times = 0;
  };

  void greet();
  void note_greeting();
  void receive_all();
  void take(std::span<const std::uint8_t> packet);
  // Each answers whether the packet brought something.
  [[nodiscard]] bool take(wire::PacketType type, wire::ByteReader& body);
  [[nodiscard]] bool take_welcome(wire::ByteReader& body);
  [[nodiscard]] bool take_refusal(wire::ByteReader& body);
  [[nodiscard]] bool take_status(wire::ByteReader& body);
  void take_round_trip(std::uint32_t stamp);
  void send_what_is_due();
  void send_again(Sent& frame);
  void poll();
  void note_asking();
  void note_answer();
  void lose_link();
  [[nodiscard]] std::uint32_t stamp() const;
  [[nodiscard]] std::uint32_t on_their_way() const { return sequence_ - executed_; }

  std::unique_ptr<PacketChannel> channel_;
  WireSettings settings_;
  firmware::Setup setup_;
  State state_ = State::closed;
  double now_ = 0.0;
  double greeted_at_ = -1.0;
  unsigned greetings_in_vain_ = 0;
  unsigned welcomes_in_vain_ = 0;           // no status came behind them
  bool asked_ = false;                      // something that is to be answered
  std::optional<double> unanswered_since_;  // the first look for an answer that was in vain

  std::uint32_t session_ = 0;
  std::uint32_t boot_ = 0;
  bool boot_known_ = false;

  std::array<Sent, kWindow> frames_;  // by number
  std::uint32_t window_ = 0;          // what board and port both have room for
  std::uint32_t sequence_ = 0;        // of the last frame sent
  std::uint32_t executed_ = 0;
  std::uint32_t waiting_ = 0;  // on the board, as in StatusNumbers
  std::uint32_t newest_answer_ = 0;
  std::uint32_t stops_ = 0;
  double sent_at_ = 0.0;  // anything
  std::uint64_t frames_sent_ = 0;
  double smoothed_trip_ = 0.0;  // s
  double trip_deviation_ = 0.0;

  firmware::Status status_;  // being read
  BoardAnswer answer_;
};

}  // namespace cnc::hal::cpu5
