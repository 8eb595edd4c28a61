#include "hal/sim/troubled_line.h"

#include <algorithm>
#include <numeric>

namespace cnc::hal::sim {

TroubledLine::TroubledLine(std::uint32_t seed) : random_(seed) {
  std::iota(order_.begin(), order_.end(), std::uint8_t{0});
}

bool TroubledLine::happens(double probability) {
  return probability > 0.0 && std::uniform_real_distribution(0.0, 1.0)(random_) < probability;
}

void TroubledLine::put(std::span<const std::uint8_t> packet, double now,
                       const LinkTrouble& trouble) {
  if (packet.empty() || trouble.cable_out || happens(trouble.loss)) return;
  const int copies = happens(trouble.duplication) ? 2 : 1;
  for (int i = 0; i < copies; ++i) {
    double arrival = now + trouble.delay;
    if (trouble.jitter > 0.0) {
      arrival += std::uniform_real_distribution(0.0, trouble.jitter)(random_);
    }
    place(packet, arrival, happens(trouble.corruption));
  }
}

/// Behind those that arrive at the same time.
void TroubledLine::place(std::span<const std::uint8_t> packet, double arrival, bool damaged) {
  if (count_ == kCapacity) return;
  const std::uint8_t free = order_[count_];
  std::size_t at = count_++;
  for (; at > 0 && packets_[order_[at - 1]].arrival > arrival; --at) order_[at] = order_[at - 1];
  order_[at] = free;
  Packet& placed = packets_[free];
  placed.arrival = arrival;
  placed.size = std::min(packet.size(), placed.bytes.size());
  std::ranges::copy(packet.first(placed.size), placed.bytes.begin());
  if (!damaged) return;
  const auto byte = std::uniform_int_distribution<std::size_t>(0, placed.size - 1)(random_);
  placed.bytes[byte] ^= static_cast<std::uint8_t>(1U << (random_() % 8));
}

std::optional<double> TroubledLine::next_arrival() const {
  return count_ > 0 ? std::optional(packets_[order_[0]].arrival) : std::nullopt;
}

std::span<const std::uint8_t> TroubledLine::take(double now) {
  if (count_ == 0 || packets_[order_[0]].arrival > now) return {};
  const Packet& packet = packets_[order_[0]];
  const auto end = order_.begin() + static_cast<std::ptrdiff_t>(count_--);
  std::rotate(order_.begin(), order_.begin() + 1, end);
  return std::span(packet.bytes).first(packet.size);
}

}  // namespace cnc::hal::sim
