// A virtual board whose process does not come to look for its packets for a while.
#include "hal/sim/posted_board.h"

#include <deque>

#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/cpu5/driver/wire_port.h"
#include "tests/hal/machine_support.h"

namespace cnc::hal::sim {
namespace {

using Packet = PostedBoard::Packet;

/// What the operating system keeps, in either direction.
struct Post {
  std::vector<Packet> to_board;
  std::deque<Packet> to_host;
};

class PostChannel final : public cpu5::PacketChannel {
 public:
  explicit PostChannel(Post& post) : post_(post) {}

  Result<void> open() override { return {}; }
  void close() override {}
  void send(std::span<const std::uint8_t> packet) override {
    post_.to_board.emplace_back(packet.begin(), packet.end());
  }
  std::span<const std::uint8_t> receive() override {
    if (post_.to_host.empty()) return {};
    packet_ = std::move(post_.to_host.front());
    post_.to_host.pop_front();
    return packet_;
  }
  [[nodiscard]] std::string name() const override { return "the post"; }

 private:
  Post& post_;
  Packet packet_;
};

/// Host and board, each with a process of its own. The host exchanges every 2 ms.
class Rig {
 public:
  Rig() {
    REQUIRE(port_->begin({.max_velocity = cpu5::firmware::velocity_of_frequency(400'000),
                          .host_timeout = cpu5::firmware::kTicksPerSecond / 10}));
    run_for(0.05, true);
    REQUIRE(answer_.connected);
  }

  void run_for(double time, bool board_looks) {
    for (const double end = now_ + time; now_ < end;) {
      now_ += 0.002;
      port_->receive(now_);
      answer_ = port_->exchange();
      if (board_looks) look();
    }
  }
  void look() { board_.look(now_, std::exchange(post_.to_board, {})); }
  /// The host waits, and takes what has come.
  [[nodiscard]] const cpu5::BoardAnswer& answer() {
    port_->receive(now_);
    return answer_ = port_->exchange();
  }
  [[nodiscard]] double& now() { return now_; }

 private:
  Post post_;
  PostedBoard board_{small_machine(), {}, [this](std::span<const std::uint8_t> packet) {
                       post_.to_host.emplace_back(packet.begin(), packet.end());
                     }};
  std::unique_ptr<cpu5::WirePort> port_ =
      std::make_unique<cpu5::WirePort>(std::make_unique<PostChannel>(post_), cpu5::WireSettings{});
  cpu5::BoardAnswer answer_;
  double now_ = 0.0;
};

}  // namespace

TEST_CASE(
    "A board that was not scheduled finds its host's packets, and does not take it for silent",
    "[hal][LNK-4]") {
  Rig rig;
  rig.run_for(0.2, false);  // twice the host's time-out, less than the host's patience
  rig.look();
  CHECK(rig.answer().connected);
  CHECK(rig.answer().status.faults == 0);
  CHECK(rig.answer().greetings == 1);
  rig.run_for(0.1, true);
  CHECK(rig.answer().status.faults == 0);
}

TEST_CASE("A host that was silent meanwhile is one", "[hal][LNK-4]") {
  Rig rig;
  rig.now() += 0.2;
  rig.look();
  rig.run_for(0.01, true);
  CHECK(rig.answer().status.faults == cpu5::firmware::kLinkLost);
}

}  // namespace cnc::hal::sim
