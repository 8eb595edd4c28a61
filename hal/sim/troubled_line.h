// One direction of a cable that LinkTrouble happens to: packets go in at a time and come out later,
// in the order in which they arrive, or not at all.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <span>

#include "hal/cpu5/wire/packet.h"
#include "hal/sim/link_trouble.h"

namespace cnc::hal::sim {

class TroubledLine {
 public:
  explicit TroubledLine(std::uint32_t seed);

  /// No allocation; more than kCapacity packets at once are lost.
  void put(std::span<const std::uint8_t> packet, double now, const LinkTrouble& trouble);
  /// When the next packet arrives.
  [[nodiscard]] std::optional<double> next_arrival() const;
  /// Takes a packet that has arrived by `now`, valid until the next call; empty: none.
  std::span<const std::uint8_t> take(double now);

 private:
  static constexpr std::size_t kCapacity = 128;

  struct Packet {
    double arrival = 0.0;
    std::size_t size = 0;
    std::array<std::uint8_t, cpu5::wire::kMaxPacket> bytes;
  };

  [[nodiscard]] bool happens(double probability);
  void place(std::span<const std::uint8_t> packet, double arrival, bool damaged);

  std::mt19937 random_;
  std::array<Packet, kCapacity> packets_;
  std::array<std::uint8_t, kCapacity> order_;  // places: first those in use as they arrive
  std::size_t count_ = 0;
};

}  // namespace cnc::hal::sim
