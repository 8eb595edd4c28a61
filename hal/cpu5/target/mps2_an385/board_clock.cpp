#include "hal/cpu5/target/mps2_an385/board_clock.h"

#include "hal/cpu5/target/mps2_an385/registers.h"

namespace cnc::hal::cpu5::target {
namespace {

// A tick is two and a half counts.
constexpr std::uint32_t kFifthsPerCount = 2;
constexpr std::uint32_t kFifthsPerTick = 5;
static_assert(kClockHertz * std::uint64_t{kFifthsPerCount} ==
              firmware::kTicksPerSecond * std::uint64_t{kFifthsPerTick});

constexpr firmware::Ticks kLongestAlarm = firmware::kTicksPerSecond / 1000;

}  // namespace

void BoardClock::start() {
  kTimer0.write(kTimerReload, 0xFFFF'FFFF);
  kTimer0.write(kTimerValue, 0xFFFF'FFFF);
  kTimer0.write(kTimerControl, kTimerEnable);
  last_count_ = count();
}

std::uint32_t BoardClock::count() { return ~kTimer0.read(kTimerValue); }

BoardClock::Ticks BoardClock::now() {
  const std::uint32_t count_now = count();
  const std::uint32_t passed = count_now - last_count_;
  last_count_ = count_now;
  const std::uint32_t fifths = fifths_ + passed * kFifthsPerCount;
  ticks_ += fifths / kFifthsPerTick;
  fifths_ = fifths % kFifthsPerTick;
  return ticks_;
}

void BoardClock::set_alarm(Ticks when, Ticks now) {
  const Ticks wanted = when - now;
  const Ticks wait = wanted < 1 ? 1 : wanted < kLongestAlarm ? wanted : kLongestAlarm;
  const auto from_now = static_cast<std::uint32_t>(wait) * kFifthsPerTick / kFifthsPerCount;
  const std::uint32_t passed = count() - last_count_;
  const std::uint32_t counts = from_now > passed ? from_now - passed : 1;
  kTimer1.write(kTimerReload, counts);
  kTimer1.write(kTimerValue, counts);
  kTimer1.write(kTimerControl, kTimerEnable | kTimerInterrupt);
}

void BoardClock::take_alarm() {
  kTimer1.write(kTimerControl, 0);
  kTimer1.write(kTimerClear, 1);
}

}  // namespace cnc::hal::cpu5::target
