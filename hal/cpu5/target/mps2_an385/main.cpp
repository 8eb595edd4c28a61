// The image: steps in the timer's interrupt, planning in PendSV below it, the link in the main
// loop.
//
// On the UART (115200 8N1) it says when a session has ended what the step interrupt has cost.
#include "hal/cpu5/firmware/board_link.h"
#include "hal/cpu5/target/mps2_an385/board_clock.h"
#include "hal/cpu5/target/mps2_an385/interrupts.h"
#include "hal/cpu5/target/mps2_an385/lan9118.h"
#include "hal/cpu5/target/mps2_an385/log.h"
#include "hal/cpu5/target/mps2_an385/pins.h"
#include "hal/cpu5/wire/crc32.h"

namespace cnc::hal::cpu5::target {
namespace {

using firmware::Ticks;

// A locally administered address; a board of a series reads its own from its EEPROM.
constexpr NetworkName kSelf{
    .mac = {0x02, 0x00, 0x43, 0x35, 0x00, 0x01}, .ip = {172, 22, 2, 100}, .port = 5005};

BoardClock clock;
Pins pins;
firmware::Core core(pins);
std::atomic<std::uint32_t> longest_interrupt = 0;  // counts of 25 MHz
std::atomic<bool> network_due = false;

/// The link begins with the first packet: when it came and what is in it is all the chance that
/// this board has for telling one power-up from another.
class Link {
 public:
  std::span<const std::uint8_t> answer(std::span<const std::uint8_t> packet,
                                       std::span<std::uint8_t> memory) {
    if (!link_) {
      const std::uint32_t chance = wire::crc32(packet) ^ BoardClock::count();
      link_.emplace(core, firmware::BoardName{.boot = chance, .name = {"MPS2 AN385"}});
    }
    return link_->answer(packet, memory);
  }
  [[nodiscard]] bool in_session() const { return link_ && link_->in_session(); }

 private:
  std::optional<firmware::BoardLink> link_;
};

Lan9118 ethernet(kEthernet);
UdpAnswer udp(kSelf);
Link link;
std::array<std::uint8_t, kMaxEthernetFrame> received;
std::array<std::uint8_t, kMaxEthernetFrame> answer;

void serve_network() {
  const auto frame = ethernet.receive(received);
  if (frame.empty()) return;
  const auto reply = udp.answer(frame, answer, [](auto packet, auto memory) {
    return link.answer(packet, memory.first(wire::kMaxPacket));
  });
  if (!reply.empty()) ethernet.send(reply);
}

void report_end_of_session() {
  static bool was_in_session = false;
  if (was_in_session && !link.in_session()) {
    log_number("step interrupt, longest, in counts of 25 MHz: ", longest_interrupt);
  }
  was_in_session = link.in_session();
}

}  // namespace

void step_interrupt() {
  const std::uint32_t begin = BoardClock::count();
  clock.take_alarm();
  const Ticks now = clock.now();
  if (core.run_until(now)) {
    kSystemControl.write(kInterruptControl, kPendPendSv);
    network_due = true;  // at least every 100 us
  }
  pins.make_edges(now);
  if (pins.take_loss()) core.report(firmware::kBadSegment);
  const Ticks due = core.next_due();
  const Ticks edge = pins.next_edge();
  clock.set_alarm(due < edge ? due : edge, now);
  const std::uint32_t spent = BoardClock::count() - begin;
  if (spent > longest_interrupt) longest_interrupt = spent;
}

void planning_interrupt() { core.plan(); }

}  // namespace cnc::hal::cpu5::target

int main() {
  using namespace cnc::hal::cpu5::target;
  start_log();
  pins.start();
  if (!ethernet.start(kSelf.mac)) log_line("no Ethernet controller");
  clock.start();
  // Of the three highest bits of a priority, 0 is the highest priority.
  kSystemControl.write(kSystemPriority3, 0xE0U << 16);
  kNvicEnable.write(0, 1U << kTimer1Number);
  clock.set_alarm(0, 0);
  log_line("CPU5 board is up");
  // It does not sleep until then: the emulator makes up for time slept in leaps of its clock. And
  // it leaves the registers of the Ethernet controller alone: to look there again and again starves
  // the emulator's network.
  while (true) {
    if (!network_due.exchange(false)) continue;
    serve_network();
    report_end_of_session();
  }
}
