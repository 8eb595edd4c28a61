// The Ethernet controller SMSC LAN9118 (data sheet DS00002266), whole frames in and out by polling.
#pragma once

#include <cstdint>
#include <span>

#include "hal/cpu5/target/mps2_an385/registers.h"
#include "hal/cpu5/target/udp_answer.h"

namespace cnc::hal::cpu5::target {

class Lan9118 {
 public:
  explicit Lan9118(Registers registers) : registers_(registers) {}

  /// False when there is no such controller.
  bool start(const MacAddress& mac);
  /// The next frame that has come, without its CRC; empty: none. Longer ones are dropped.
  std::span<const std::uint8_t> receive(std::span<std::uint8_t> memory);
  /// Dropped when there is no room: whoever waits for it asks again.
  void send(std::span<const std::uint8_t> frame);

 private:
  void write_mac(std::uint32_t index, std::uint32_t value);
  void start_link();
  void forget_sent();

  Registers registers_;
};

}  // namespace cnc::hal::cpu5::target
