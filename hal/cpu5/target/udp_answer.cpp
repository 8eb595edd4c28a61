#include "hal/cpu5/target/udp_answer.h"

#include <algorithm>

namespace cnc::hal::cpu5::target {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Where things stand in a frame.
constexpr std::size_t kTargetMac = 0;
constexpr std::size_t kSourceMac = 6;
constexpr std::size_t kEtherType = 12;
constexpr std::size_t kNetwork = 14;  // what ARP and IP begin with

constexpr std::uint16_t kArpType = 0x0806;
constexpr std::size_t kArpSenderMac = 22;
constexpr std::size_t kArpSenderIp = 28;
constexpr std::size_t kArpTargetMac = 32;
constexpr std::size_t kArpTargetIp = 38;
constexpr std::size_t kArpEnd = 42;
// Ethernet, IPv4, lengths of their addresses, and the question.
constexpr std::array<std::uint8_t, 8> kArpQuestion{0, 1, 0x08, 0x00, 6, 4, 0, 1};

constexpr std::uint16_t kIpType = 0x0800;
constexpr std::size_t kIpLength = 16;
constexpr std::size_t kIpFragment = 20;
constexpr std::size_t kIpTimeToLive = 22;
constexpr std::size_t kIpProtocol = 23;
constexpr std::size_t kIpChecksum = 24;
constexpr std::size_t kIpSource = 26;
constexpr std::size_t kIpTarget = 30;
constexpr std::size_t kUdp = 34;
constexpr std::uint8_t kVersionAndWords = 0x45;  // IPv4, five words: no options
constexpr std::uint8_t kUdpProtocol = 17;
constexpr std::size_t kIpHeader = 20;
constexpr std::size_t kUdpHeader = 8;

std::uint16_t word_at(Bytes bytes, std::size_t place) {
  return static_cast<std::uint16_t>(bytes[place] << 8 | bytes[place + 1]);
}

void put_word(std::span<std::uint8_t> bytes, std::size_t place, std::size_t value) {
  bytes[place] = static_cast<std::uint8_t>(value >> 8);
  bytes[place + 1] = static_cast<std::uint8_t>(value);
}

void put(std::span<std::uint8_t> bytes, std::size_t place, Bytes what) {
  std::ranges::copy(what, bytes.subspan(place).begin());
}

bool stands_at(Bytes bytes, std::size_t place, Bytes what) {
  return std::ranges::equal(bytes.subspan(place, what.size()), what);
}

// RFC 1071.
std::uint16_t internet_checksum(Bytes header) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < header.size(); i += 2) sum += word_at(header, i);
  while (sum > 0xFFFF) sum = (sum & 0xFFFF) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

}  // namespace

bool UdpAnswer::asks_for_me(Bytes frame) const {
  return frame.size() >= kArpEnd && word_at(frame, kEtherType) == kArpType &&
         stands_at(frame, kNetwork, kArpQuestion) && stands_at(frame, kArpTargetIp, self_.ip);
}

Bytes UdpAnswer::answer_arp(Bytes in, std::span<std::uint8_t> out) const {
  put(out, kTargetMac, in.subspan(kArpSenderMac, 6));
  put(out, kSourceMac, self_.mac);
  put_word(out, kEtherType, kArpType);
  put(out, kNetwork, kArpQuestion);
  put_word(out, kNetwork + 6, 2);  // the answer
  put(out, kArpSenderMac, self_.mac);
  put(out, kArpSenderIp, self_.ip);
  put(out, kArpTargetMac, in.subspan(kArpSenderMac, 10));  // and the address behind it
  return out.first(kArpEnd);
}

Bytes UdpAnswer::datagram_for_me(Bytes frame) const {
  if (frame.size() < kPayloadPlace || word_at(frame, kEtherType) != kIpType) return {};
  constexpr std::uint16_t kAnyFragment = 0x3FFF;  // more to come, or not the first
  const bool for_me = frame[kNetwork] == kVersionAndWords && frame[kIpProtocol] == kUdpProtocol &&
                      (word_at(frame, kIpFragment) & kAnyFragment) == 0 &&
                      stands_at(frame, kIpTarget, self_.ip) &&
                      word_at(frame, kUdp + 2) == self_.port;
  const std::size_t udp_length = word_at(frame, kUdp + 4);
  const bool whole = udp_length >= kUdpHeader &&
                     udp_length + kIpHeader <= word_at(frame, kIpLength) &&
                     kUdp + udp_length <= frame.size();
  if (!for_me || !whole) return {};
  return frame.subspan(kPayloadPlace, udp_length - kUdpHeader);
}

// A UDP checksum of 0 says that there is none.
Bytes UdpAnswer::answer_datagram(Bytes in, std::span<std::uint8_t> out, std::size_t payload) const {
  put(out, kTargetMac, in.subspan(kSourceMac, 6));
  put(out, kSourceMac, self_.mac);
  put_word(out, kEtherType, kIpType);
  out[kNetwork] = kVersionAndWords;
  out[kNetwork + 1] = 0;
  put_word(out, kIpLength, kIpHeader + kUdpHeader + payload);
  put_word(out, kIpLength + 2, 0);
  put_word(out, kIpFragment, 0);
  out[kIpTimeToLive] = 64;
  out[kIpProtocol] = kUdpProtocol;
  put_word(out, kIpChecksum, 0);
  put(out, kIpSource, self_.ip);
  put(out, kIpTarget, in.subspan(kIpSource, 4));
  put_word(out, kIpChecksum, internet_checksum(out.subspan(kNetwork, kIpHeader)));
  put_word(out, kUdp, self_.port);
  put(out, kUdp + 2, in.subspan(kUdp, 2));
  put_word(out, kUdp + 4, kUdpHeader + payload);
  put_word(out, kUdp + 6, 0);
  return out.first(kPayloadPlace + payload);
}

}  // namespace cnc::hal::cpu5::target
