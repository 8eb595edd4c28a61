#include "gui/jog_lease.h"

#include <algorithm>
#include <cmath>

namespace cnc::gui {
namespace {

api::JogVelocities sum_of(const std::map<JogInput, api::JogVelocity>& held) {
  api::AxisValues sum;
  for (const auto& [input, velocity] : held) sum[velocity.axis] += velocity.rate;
  api::JogVelocities velocities;
  for (const api::Axis axis : api::kAllAxes) {
    if (sum[axis] != 0.0) velocities.push_back({axis, std::clamp(sum[axis], -1.0, 1.0)});
  }
  return velocities;
}

}  // namespace

JogLease::JogLease(QObject* parent, Clock clock) : QObject(parent), clock_(std::move(clock)) {
  timer_.setTimerType(Qt::PreciseTimer);
  timer_.setInterval(kRenewal);
  connect(&timer_, &QTimer::timeout, this, [this] {
    const bool lease_ran_out = clock_() - last_renewal_ > kLease;
    if (lease_ran_out) return release_all();
    renew();
  });
}

void JogLease::hold(const JogInput& input, api::JogVelocity velocity) {
  if (!allowed_) return;
  held_[input] = velocity;
  renew();
}

void JogLease::slow_down(const JogInput& input, double rate) {
  const auto found = held_.find(input);
  if (found == held_.end() || std::abs(found->second.rate) <= rate) return;
  found->second.rate = std::copysign(rate, found->second.rate);
  renew();
}

void JogLease::release(const JogInput& input) {
  if (held_.erase(input) > 0) renew_or_end();
}

void JogLease::release_all() {
  if (held_.empty()) return;
  held_.clear();
  renew_or_end();
}

void JogLease::set_allowed(bool allowed) {
  allowed_ = allowed;
  if (!allowed_) release_all();
}

void JogLease::renew() {
  last_renewal_ = clock_();
  timer_.start();
  emit renewed(sum_of(held_));
}

void JogLease::renew_or_end() {
  if (is_holding()) return renew();
  timer_.stop();
  emit ended();
}

}  // namespace cnc::gui
