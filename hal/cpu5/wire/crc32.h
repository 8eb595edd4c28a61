// CRC-32 as Ethernet, zip and zlib have it: polynomial 0x04C11DB7 reflected, begins and ends
// inverted; of "123456789" 0xCBF43926.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace cnc::hal::cpu5::wire {

namespace detail {

consteval std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t value = byte;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1U) * 0xEDB88320U);
    table[byte] = value;
  }
  return table;
}

inline constexpr std::array<std::uint32_t, 256> kCrcTable = make_crc_table();

}  // namespace detail

[[nodiscard]] constexpr std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = ~std::uint32_t{0};
  for (const std::uint8_t byte : bytes) {
    value = (value >> 8) ^ detail::kCrcTable[(value ^ byte) & 0xFFU];
  }
  return ~value;
}

}  // namespace cnc::hal::cpu5::wire
