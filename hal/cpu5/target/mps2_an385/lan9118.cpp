#include "hal/cpu5/target/mps2_an385/lan9118.h"

namespace cnc::hal::cpu5::target {
namespace {

// Registers of the bus side.
constexpr std::uint32_t kReceiveData = 0x00;
constexpr std::uint32_t kSendData = 0x20;
constexpr std::uint32_t kReceiveStatus = 0x40;
constexpr std::uint32_t kSendStatus = 0x48;
constexpr std::uint32_t kByteTest = 0x64;
constexpr std::uint32_t kSendConfig = 0x70;
constexpr std::uint32_t kHardwareConfig = 0x74;
constexpr std::uint32_t kReceiveLevel = 0x7C;
constexpr std::uint32_t kSendLevel = 0x80;
constexpr std::uint32_t kMacCommand = 0xA4;
constexpr std::uint32_t kMacData = 0xA8;

constexpr std::uint32_t kByteTestValue = 0x8765'4321;
constexpr std::uint32_t kSendOn = 1U << 1;
constexpr std::uint32_t kSoftReset = 1U << 0;
constexpr std::uint32_t kStoreAndForward = 1U << 20;
constexpr std::uint32_t kSendFifo5K = 5U << 16;
constexpr std::uint32_t kBusy = 1U << 31;

// Registers of the MAC, behind kMacCommand.
constexpr std::uint32_t kMacControl = 1;
constexpr std::uint32_t kMacAddressHigh = 2;
constexpr std::uint32_t kMacAddressLow = 3;
constexpr std::uint32_t kPhyAccess = 6;
constexpr std::uint32_t kPhyData = 7;
constexpr std::uint32_t kFullDuplex = 1U << 20;
constexpr std::uint32_t kMacSend = 1U << 3;
constexpr std::uint32_t kMacReceive = 1U << 2;

// The PHY inside has number 1; its register 0 with auto-negotiation on, and begun anew.
constexpr std::uint32_t kWriteControlOfPhy = 1U << 11 | 1U << 1 | 1U;
constexpr std::uint32_t kNegotiate = 1U << 12 | 1U << 9;

constexpr std::uint32_t kReceiveError = 1U << 15;
constexpr std::size_t kCrc = 4;
constexpr std::size_t kPadTo = 60;  // the shortest frame on the wire, without its CRC

constexpr std::size_t words_of(std::size_t bytes) { return (bytes + 3) / 4; }

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t place) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4 && place + i < bytes.size(); ++i) {
    word |= std::uint32_t{bytes[place + i]} << (8 * i);
  }
  return word;
}

}  // namespace

bool Lan9118::start(const MacAddress& mac) {
  if (registers_.read(kByteTest) != kByteTestValue) return false;
  registers_.write(kHardwareConfig, kSoftReset);
  while ((registers_.read(kHardwareConfig) & kSoftReset) != 0) {
  }
  registers_.write(kHardwareConfig, kStoreAndForward | kSendFifo5K);
  write_mac(kMacAddressLow, word_at(mac, 0));
  write_mac(kMacAddressHigh, word_at(mac, 4));
  start_link();
  write_mac(kMacControl, kFullDuplex | kMacSend | kMacReceive);
  registers_.write(kSendConfig, kSendOn);
  return true;
}

void Lan9118::start_link() {
  write_mac(kPhyData, kNegotiate);
  write_mac(kPhyAccess, kWriteControlOfPhy);
}

void Lan9118::write_mac(std::uint32_t index, std::uint32_t value) {
  while ((registers_.read(kMacCommand) & kBusy) != 0) {
  }
  registers_.write(kMacData, value);
  registers_.write(kMacCommand, kBusy | index);
}

std::span<const std::uint8_t> Lan9118::receive(std::span<std::uint8_t> memory) {
  const std::uint32_t waiting = (registers_.read(kReceiveLevel) >> 16) & 0xFF;
  if (waiting == 0) return {};
  const std::uint32_t status = registers_.read(kReceiveStatus);
  const std::size_t with_crc = (status >> 16) & 0x3FFF;
  for (std::size_t word = 0; word < words_of(with_crc); ++word) {
    std::uint32_t bits = registers_.read(kReceiveData);
    for (std::size_t i = 4 * word; i < 4 * word + 4 && i < memory.size(); ++i) {
      memory[i] = static_cast<std::uint8_t>(bits);
      bits >>= 8;
    }
  }
  const bool good = (status & kReceiveError) == 0 && with_crc > kCrc;
  if (!good || with_crc - kCrc > memory.size()) return {};
  return memory.first(with_crc - kCrc);
}

// Who asks again does not need to know what became of the frames before.
void Lan9118::forget_sent() {
  for (std::uint32_t left = registers_.read(kSendLevel) >> 16 & 0xFF; left > 0; --left) {
    static_cast<void>(registers_.read(kSendStatus));
  }
}

// Words of command A and B, then the frame: one piece, from an address that is a multiple of four.
void Lan9118::send(std::span<const std::uint8_t> frame) {
  forget_sent();
  const std::size_t size = frame.size() < kPadTo ? kPadTo : frame.size();
  if ((registers_.read(kSendLevel) & 0xFFFF) < 4 * (words_of(size) + 2)) return;
  constexpr std::uint32_t kFirstAndLast = 1U << 13 | 1U << 12;
  registers_.write(kSendData, kFirstAndLast | size);
  registers_.write(kSendData, size);
  for (std::size_t word = 0; word < words_of(size); ++word) {
    registers_.write(kSendData, word_at(frame, 4 * word));
  }
}

}  // namespace cnc::hal::cpu5::target
