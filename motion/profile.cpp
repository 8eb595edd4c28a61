#include "motion/profile.h"

#include "motion/acceleration_profile.h"
#include "motion/jerk_profile.h"

namespace cnc::motion {

std::unique_ptr<Profile> make_profile(const AxisLimits& limits, double max_duration,
                                      bool goes_back) {
  if (limits.limit_jerk()) return std::make_unique<JerkProfile>(limits, max_duration, goes_back);
  return std::make_unique<AccelerationProfile>(limits, max_duration, goes_back);
}

}  // namespace cnc::motion
