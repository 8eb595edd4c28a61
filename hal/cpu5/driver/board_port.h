// How the driver reaches a board: numbered frames there, the newest status back.
#pragma once

#include <cstdint>

#include "config/error.h"
#include "hal/controller.h"
#include "hal/cpu5/firmware/host_frame.h"
#include "hal/cpu5/wire/messages.h"

namespace cnc::hal::cpu5 {

/// What is known of the board after an exchange.
struct BoardAnswer {
  bool connected = false;
  LinkObstacle obstacle{};      ///< while not connected, as far as is known
  std::uint32_t greetings = 0;  ///< sessions so far: one more after every loss of the link
  bool counts_lost = false;     ///< the board was reset before the present session
  std::uint64_t frames_done =
      0;  ///< frames that `status` knows of, or that were lost with the link
  firmware::Status status{};
  wire::Identity identity{};  ///< of the board that it was last connected to
  double round_trip = 0.0;    ///< s, of the last answer
  PacketCounts packets{};
};

class BoardPort {
 public:
  virtual ~BoardPort() = default;

  /// Greets the board; may take a second. When that fails, exchange() goes on trying.
  virtual Result<wire::Identity> open(const firmware::Setup& setup) = 0;
  virtual void close() = 0;

  // Real-time: no allocation, no lock, no waiting.

  /// Frames that send() takes now; 0 without a board.
  [[nodiscard]] virtual std::uint32_t room() const = 0;
  /// Delivers `frame` exactly once, after those before it, as long as the link lasts.
  virtual void send(const firmware::HostFrame& frame) = 0;
  [[nodiscard]] virtual std::uint64_t frames_sent() const = 0;
  /// Overtakes the frames on their way, whose segments and outputs become void. Frames sent from
  /// now on count.
  virtual void quick_stop() = 0;
  /// The first half of an exchange: reads what has come. `now` in seconds never goes back.
  virtual void receive(double now) = 0;
  /// The second half, behind the frames that were sent meanwhile.
  virtual const BoardAnswer& exchange() = 0;
};

}  // namespace cnc::hal::cpu5
