#include "motion/profile.h"

#include <algorithm>

#include "motion/acceleration_profile.h"
#include "motion/jerk_profile.h"
#include "motion/planner.h"

namespace cnc::motion {

std::unique_ptr<Profile> make_profile(const PlannerSettings& settings) {
  const AxisLimits& limits = settings.limits;
  const double max_duration = std::clamp(settings.max_setpoint_duration, 0.0005, 0.1);
  const bool goes_back = settings.most_taken_back > 0;
  if (limits.limit_jerk()) return std::make_unique<JerkProfile>(limits, max_duration, goes_back);
  return std::make_unique<AccelerationProfile>(limits, max_duration, goes_back);
}

}  // namespace cnc::motion
