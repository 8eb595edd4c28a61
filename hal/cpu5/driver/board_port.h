// How the driver reaches a board: a cable, a socket, or a function call into the virtual board.
#pragma once

#include "config/error.h"
#include "hal/cpu5/firmware/host_frame.h"

namespace cnc::hal::cpu5 {

class BoardPort {
 public:
  virtual ~BoardPort() = default;

  /// The board's status as it is then.
  virtual Result<firmware::Status> open(const firmware::Setup& setup) = 0;
  virtual void close() = 0;
  /// Delivers `frame` exactly once and brings the newest status. False when the board does not
  /// answer any more; the frame is then not delivered and `status` not touched. `now` in seconds
  /// never goes back. Real-time: no allocation, no lock, bounded time.
  virtual bool exchange(double now, const firmware::HostFrame& frame, firmware::Status& status) = 0;
};

}  // namespace cnc::hal::cpu5
