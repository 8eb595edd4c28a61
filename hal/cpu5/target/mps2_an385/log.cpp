#include "hal/cpu5/target/mps2_an385/log.h"

#include "hal/cpu5/target/mps2_an385/registers.h"

namespace cnc::hal::cpu5::target {
namespace {

constexpr std::uint32_t kBaud = 115'200;

void put(char letter) {
  while ((kUart0.read(kUartState) & kUartFull) != 0) {
  }
  kUart0.write(kUartData, static_cast<std::uint8_t>(letter));
}

void put(const char* text) {
  while (*text != '\0') put(*text++);
}

void put(std::uint32_t number) {
  if (number >= 10) put(number / 10);
  put(static_cast<char>('0' + number % 10));
}

}  // namespace

void start_log() {
  kUart0.write(kUartDivider, kClockHertz / kBaud);
  kUart0.write(kUartControl, kUartSend);
}

void log_line(const char* text) {
  put(text);
  put("\r\n");
}

void log_number(const char* text, std::uint32_t number) {
  put(text);
  put(number);
  put("\r\n");
}

}  // namespace cnc::hal::cpu5::target
