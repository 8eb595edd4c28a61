#include "hal/cpu5/wire/cobs.h"

namespace cnc::hal::cpu5::wire {

std::size_t write_cobs(std::span<const std::uint8_t> packet, std::span<std::uint8_t> line) {
  std::size_t block = 0;  // where its length goes
  std::size_t end = 1;
  const auto close_block = [&] {
    line[block] = static_cast<std::uint8_t>(end - block);
    block = end++;
  };
  for (const std::uint8_t byte : packet) {
    if (byte != 0) line[end++] = byte;
    if (byte == 0 || end - block == 0xFF) close_block();
  }
  close_block();
  line[block] = 0;
  return end;
}

}  // namespace cnc::hal::cpu5::wire
