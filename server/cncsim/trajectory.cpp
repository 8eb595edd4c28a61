#include "server/cncsim/trajectory.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <iterator>

namespace cnc::server {
namespace {

constexpr double kRowPeriod = 1e-3;

/// Extremes of a cubic's position: at its ends and where its velocity is zero.
template <typename Take>
void visit_extremes(const motion::AxisCubic& cubic, Take take) {
  take(cubic.p0);
  take(cubic.p1);
  // v(t) = v0 + a t + j t²/2 = 0, in the form that loses no digits (Numerical Recipes 5.6).
  const double a = cubic.start_acceleration();
  const double j = cubic.jerk();
  const double discriminant = a * a - 2.0 * j * cubic.v0;
  if (discriminant < 0.0) return;
  const double q = -(a + std::copysign(std::sqrt(discriminant), a));
  for (const double t : {q / j, 2.0 * cubic.v0 / q})
    if (t > 0.0 && t < cubic.duration) take(cubic.position(t));
}

double peak_velocity(const motion::AxisCubic& cubic) {
  double peak = std::max(std::abs(cubic.v0), std::abs(cubic.v1));
  const double t = -cubic.start_acceleration() / cubic.jerk();
  if (t > 0.0 && t < cubic.duration) peak = std::max(peak, std::abs(cubic.velocity(t)));
  return peak;
}

}  // namespace

TrajectoryStatistics::TrajectoryStatistics(const Position& start) : position_(start) {
  summary_.min = summary_.max = start;
}

void TrajectoryStatistics::add(const motion::Setpoint& setpoint) {
  summary_.time += setpoint.duration;
  // Setpoints are short and almost straight: the chord is the arc to a part in 10^7.
  summary_.distance += linear_length(setpoint.position - position_);
  for (const Axis axis : kAllAxes) {
    const motion::AxisCubic cubic = motion::cubic_of(axis, position_, velocity_, setpoint);
    visit_extremes(cubic, [&](double p) {
      summary_.min[axis] = std::min(summary_.min[axis], p);
      summary_.max[axis] = std::max(summary_.max[axis], p);
    });
    double& velocity = summary_.max_velocity[axis];
    velocity = std::max(velocity, peak_velocity(cubic));
    double& acceleration = summary_.max_acceleration[axis];
    acceleration = std::max(
        {acceleration, std::abs(cubic.start_acceleration()), std::abs(cubic.end_acceleration())});
  }
  position_ = setpoint.position;
  velocity_ = setpoint.velocity;
}

void TrajectoryStatistics::restart(const Position& position) {
  position_ = position;
  velocity_ = {};
}

void TrajectoryRecorder::restart(const Position& position) {
  position_ = position;
  velocity_ = {};
}

Result<TrajectoryRecorder> TrajectoryRecorder::create(const std::filesystem::path& path,
                                                      const Position& start) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr)
    return fail(ErrorCode::file_not_writable, fmt::format("Cannot write the recording {}: {}.",
                                                          path.string(), std::strerror(errno)));
  TrajectoryRecorder recorder(path, file, start);
  std::fputs("t,x,y,z,a,b,c,f,line\n", file);
  return recorder;
}

TrajectoryRecorder::TrajectoryRecorder(const std::filesystem::path& path, std::FILE* file,
                                       const Position& start)
    : path_(path), file_(file), position_(start) {}

void TrajectoryRecorder::add(const motion::Setpoint& setpoint) {
  const double end = begin_ + setpoint.duration;
  for (double t = kRowPeriod * static_cast<double>(next_row_); t < end;
       t = kRowPeriod * static_cast<double>(next_row_)) {
    Position position;
    for (const Axis axis : kAllAxes)
      position[axis] = motion::cubic_of(axis, position_, velocity_, setpoint).position(t - begin_);
    write_row(t, position, setpoint);
    ++next_row_;
  }
  begin_ = end;
  position_ = setpoint.position;
  velocity_ = setpoint.velocity;
  last_ = setpoint;
}

void TrajectoryRecorder::write_row(double t, const Position& position, const motion::Setpoint& of) {
  fmt::memory_buffer row;
  fmt::format_to(std::back_inserter(row), "{:.3f}", t);
  for (const Axis axis : kAllAxes)
    fmt::format_to(std::back_inserter(row), ",{:.9f}", position[axis]);
  fmt::format_to(std::back_inserter(row), ",{:.6g},{}\n", of.feed_limit, of.tag.line);
  if (std::fwrite(row.data(), 1, row.size(), file_.get()) != row.size()) failed_ = true;
}

/// The end lies between two rows: it is shown at the next full millisecond, where the machine
/// stands.
Result<void> TrajectoryRecorder::finish() {
  write_row(kRowPeriod * static_cast<double>(next_row_), position_, last_);
  if (std::fflush(file_.get()) != 0 || failed_)
    return fail(ErrorCode::file_not_writable,
                fmt::format("The recording {} could not be written completely: {}.", path_.string(),
                            std::strerror(errno)));
  return {};
}

}  // namespace cnc::server
