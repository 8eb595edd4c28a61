// As much of ARP, IPv4 and UDP (RFC 826, 791, 768) as a board needs that only ever answers: to
// whoever asks for its address, and to datagrams for its port. No heap, no state: the answer to a
// frame goes back to where the frame came from.
//
// What is damaged, cut off, in fragments, or for somebody else is passed over in silence. Checksums
// of what comes are left to Ethernet's and to the packets' own CRC.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace cnc::hal::cpu5::target {

using MacAddress = std::array<std::uint8_t, 6>;
using IpAddress = std::array<std::uint8_t, 4>;

struct NetworkName {
  MacAddress mac{};
  IpAddress ip{};
  std::uint16_t port = 0;
};

/// Without the CRC at its end.
inline constexpr std::size_t kMaxEthernetFrame = 1514;

class UdpAnswer {
 public:
  explicit UdpAnswer(const NetworkName& self) : self_(self) {}

  /// `handler(payload, memory)` writes its answer into `memory` and returns it, or nothing. The
  /// frame to be sent is in `out` (kMaxEthernetFrame bytes); empty: none. `in` and `out` differ.
  template <typename Handler>
  std::span<const std::uint8_t> answer(std::span<const std::uint8_t> in,
                                       std::span<std::uint8_t> out, Handler handler) const {
    if (asks_for_me(in)) return answer_arp(in, out);
    const std::span<const std::uint8_t> payload = datagram_for_me(in);
    if (payload.empty()) return {};
    const std::span<const std::uint8_t> answer = handler(payload, out.subspan(kPayloadPlace));
    if (answer.empty()) return {};
    return answer_datagram(in, out, answer.size());
  }

 private:
  static constexpr std::size_t kPayloadPlace = 42;  // Ethernet 14, IPv4 20, UDP 8

  [[nodiscard]] bool asks_for_me(std::span<const std::uint8_t> frame) const;
  [[nodiscard]] std::span<const std::uint8_t> datagram_for_me(
      std::span<const std::uint8_t> frame) const;
  std::span<const std::uint8_t> answer_arp(std::span<const std::uint8_t> in,
                                           std::span<std::uint8_t> out) const;
  std::span<const std::uint8_t> answer_datagram(std::span<const std::uint8_t> in,
                                                std::span<std::uint8_t> out,
                                                std::size_t payload) const;

  NetworkName self_;
};

}  // namespace cnc::hal::cpu5::target
