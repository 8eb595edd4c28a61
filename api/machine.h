// Who answers: versions, what the machine is, how punctual its link is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "api/axis.h"

namespace cnc::api {

/// The API version that this library was built for. A server with another major version is refused
/// at connect; minor versions only add what old clients do not notice.
inline constexpr std::uint32_t kApiMajor = 1;
inline constexpr std::uint32_t kApiMinor = 0;

struct ServerVersion {
  std::string server;  ///< "0.1.0"
  std::uint32_t api_major = 0;
  std::uint32_t api_minor = 0;
  std::string controller;  ///< what is connected, for example "virtual CPU5 board"
};

struct AxisDescription {
  Axis axis = Axis::X;
  double negative_limit = 0.0;  ///< machine coordinates
  double positive_limit = 0.0;
  double max_velocity = 0.0;
  double max_acceleration = 0.0;
  double max_jerk = 0.0;  ///< 0: no limit
  double home_position = 0.0;
};

struct Machine {
  bool inch = false;                  ///< how to display; the API stays in mm
  std::vector<AxisDescription> axes;  ///< visible axes only, in the order X … C
  bool homing_mandatory = false;
  std::string picture_folder;  ///< on the server's computer: <title>.png of a Question
};

/// Cycles whose value was below `upper` and not below the upper of the bin before.
struct HistogramBin {
  double upper = 0.0;  ///< s; the last bin's is infinity
  std::uint64_t count = 0;
};

/// Between server and board. All but `resent` are exclusive.
struct PacketCounts {
  std::uint64_t sent = 0;
  std::uint64_t resent = 0;       ///< of those sent: again, because no answer had come
  std::uint64_t answered = 0;     ///< have come, and brought something new
  std::uint64_t passed_over = 0;  ///< have come whole, of another session or behind a newer one
  std::uint64_t corrupted = 0;    ///< have come damaged
};

/// `unknown`: of a newer server.
enum class LatchSource : std::uint8_t { home, probe, spindle_index, estop, unknown };

/// What a latch of the board has caught: where the axes were at that very step.
struct LatchCatch {
  LatchSource source = LatchSource::unknown;
  std::optional<Axis> axis;  ///< whose home switch; of a home latch only
  double age = 0.0;          ///< s since then, on the board's clock
  std::uint32_t count = 0;   ///< spindle index and estop: how often since the board's power-up
  AxisValues position;       ///< machine coordinates; of a home latch only its axis is told
};

struct LinkStatistics {
  bool real_time = false;   ///< SCHED_FIFO and locked memory were granted
  double cycle_time = 0.0;  ///< nominal, s
  std::uint64_t cycles = 0;
  double max_lateness = 0.0;  ///< worst delay of a cycle's start, s
  double max_work = 0.0;      ///< longest cycle, s
  std::vector<HistogramBin> lateness;
  std::vector<HistogramBin> work;
  /// s of motion left in the board, lowest seen while moving with more to come; 1e9: never moved
  double lowest_fifo_time = 0.0;
  std::vector<HistogramBin> fifo_time;  ///< in each cycle while moving with more to come
  double last_round_trip = 0.0;         ///< s from a request to its answer, the newest
  double mean_round_trip = 0.0;
  double max_round_trip = 0.0;
  std::vector<HistogramBin> round_trip;  ///< of each cycle that brought an answer
  PacketCounts packets;
  bool connected = false;      ///< there is a link to the board now
  std::uint32_t sessions = 0;  ///< links made since the server started; a reset does not clear it
  std::string board_name;      ///< of the board that it is, or was last, connected to
  std::uint64_t board_serial = 0;
  std::vector<LatchCatch> latches;  ///< the last of each latch that has caught something
};

}  // namespace cnc::api
