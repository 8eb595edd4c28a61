// Where things stand on the MPS2 board with the image AN385 (ARM DAI 0385): a Cortex-M3 at 25 MHz.
#pragma once

#include <cstdint>

namespace cnc::hal::cpu5::target {

// An address is a number; only here it becomes a place.
class Registers {
 public:
  constexpr explicit Registers(std::uint32_t base) : base_(base) {}

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) const { return *place(offset); }
  void write(std::uint32_t offset, std::uint32_t value) const { *place(offset) = value; }

 private:
  [[nodiscard]] volatile std::uint32_t* place(std::uint32_t offset) const {
    return reinterpret_cast<volatile std::uint32_t*>(base_ + offset);
  }

  std::uint32_t base_;
};

inline constexpr std::uint32_t kClockHertz = 25'000'000;

// CMSDK APB timer: counts down, and begins anew from kTimerReload.
inline constexpr Registers kTimer0{0x4000'0000};
inline constexpr Registers kTimer1{0x4000'1000};
inline constexpr std::uint32_t kTimerControl = 0x00;
inline constexpr std::uint32_t kTimerValue = 0x04;
inline constexpr std::uint32_t kTimerReload = 0x08;
inline constexpr std::uint32_t kTimerClear = 0x0C;
inline constexpr std::uint32_t kTimerEnable = 1U << 0;
inline constexpr std::uint32_t kTimerInterrupt = 1U << 3;
inline constexpr unsigned kTimer1Number = 9;  // of its interrupt

// CMSDK APB UART.
inline constexpr Registers kUart0{0x4000'4000};
inline constexpr std::uint32_t kUartData = 0x00;
inline constexpr std::uint32_t kUartState = 0x04;
inline constexpr std::uint32_t kUartControl = 0x08;
inline constexpr std::uint32_t kUartDivider = 0x10;
inline constexpr std::uint32_t kUartFull = 1U << 0;
inline constexpr std::uint32_t kUartSend = 1U << 0;

// CMSDK AHB GPIO, sixteen pins each.
inline constexpr Registers kPulsePins{0x4001'0000};   ///< out: step 0 … 5, direction 8 … 13
inline constexpr Registers kInputPins{0x4001'1000};   ///< in: home 0 … 5, see pins.cpp
inline constexpr Registers kOutputPins{0x4001'2000};  ///< out: see pins.cpp
inline constexpr std::uint32_t kPinsIn = 0x00;
inline constexpr std::uint32_t kPinsOut = 0x04;
inline constexpr std::uint32_t kPinsDrive = 0x10;

inline constexpr Registers kEthernet{0x4020'0000};

// Cortex-M3 (ARM DDI 0403).
inline constexpr Registers kNvicEnable{0xE000'E100};
inline constexpr Registers kNvicPriority{0xE000'E400};
inline constexpr Registers kSystemControl{0xE000'ED00};
inline constexpr std::uint32_t kInterruptControl = 0x04;
inline constexpr std::uint32_t kSystemPriority3 = 0x20;  // PendSV in bits 16 … 23
inline constexpr std::uint32_t kPendPendSv = 1U << 28;

}  // namespace cnc::hal::cpu5::target
