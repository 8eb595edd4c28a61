// A board that welcomes, or refuses, as a test wants it to, and executes nothing.
#pragma once

#include <utility>
#include <variant>

#include "hal/cpu5/driver/packet_channel.h"
#include "hal/cpu5/wire/messages.h"

namespace cnc::hal::sim {

/// What it answers, held by the test beside the port that owns the board.
struct Pretence {
  cpu5::wire::Identity identity{.serial = 7,
                                .boot = 1,
                                .max_step_frequency = 495'000,
                                .fifo_capacity = 256,
                                .axes = 6,
                                .window = 4};
  /// Instead of every other answer.
  std::optional<cpu5::wire::Refusal> refusal{};
  bool is_mute = false;
  bool is_mute_behind_greeting = false;
  int looks_elsewhere = 0;  ///< that the port has asked for
};

class PretendBoard final : public cpu5::PacketChannel {
 public:
  explicit PretendBoard(Pretence& pretence) : pretence_(pretence) {}

  Result<void> open() override { return {}; }
  void close() override {}
  void send(std::span<const std::uint8_t> packet) override {
    auto asked = cpu5::wire::open_packet(packet);
    asked_ = asked->header;
    if (asked_->type == cpu5::wire::PacketType::frame) ++frames_;
    if (asked_->type == cpu5::wire::PacketType::hello) frames_ = 0;
  }
  std::span<const std::uint8_t> receive() override {
    const auto asked = std::exchange(asked_, std::nullopt);
    if (!asked || pretence_.is_mute) return {};
    const bool greets = asked->type == cpu5::wire::PacketType::hello;
    if (pretence_.is_mute_behind_greeting && !greets) return {};
    return answer(*asked);
  }
  void look_elsewhere() override { ++pretence_.looks_elsewhere; }
  [[nodiscard]] std::string name() const override { return "the other end"; }

 private:
  std::span<const std::uint8_t> answer(const cpu5::wire::PacketHeader& asked) {
    using cpu5::wire::PacketType;
    const bool greets = asked.type == PacketType::hello;
    const PacketType type = pretence_.refusal ? PacketType::refusal
                            : greets          ? PacketType::welcome
                                              : PacketType::status;
    cpu5::wire::PacketWriter packet(memory_, type, asked.session);
    if (pretence_.refusal) {
      cpu5::wire::put_refusal(packet.body(), *pretence_.refusal);
    } else if (greets) {
      cpu5::wire::put_identity(packet.body(), pretence_.identity);
    } else {
      cpu5::wire::put_status(packet.body(), {.answer = ++answers_, .executed = frames_}, {});
    }
    return packet.finish();
  }

  Pretence& pretence_;
  std::optional<cpu5::wire::PacketHeader> asked_;
  std::uint32_t answers_ = 0;
  std::uint32_t frames_ = 0;
  std::array<std::uint8_t, cpu5::wire::kMaxPacket> memory_{};
};

}  // namespace cnc::hal::sim
