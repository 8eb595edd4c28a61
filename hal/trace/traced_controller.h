// Any Controller, with everything that passes recorded in a ring. Real-time where that is.
#pragma once

#include <memory>
#include <utility>

#include "hal/trace/ring.h"

namespace cnc::hal::trace {

class TracedController final : public Controller {
 public:
  /// `ring` outlives it; nobody else writes to it.
  TracedController(std::unique_ptr<Controller> controller, Ring& ring)
      : controller_(std::move(controller)), ring_(ring) {}

  Result<Capabilities> connect() override { return controller_->connect(); }
  void disconnect() override { controller_->disconnect(); }

  const ControllerStatus& exchange(double now) override {
    const std::uint64_t frame = controller_->next_frame();
    const ControllerStatus& status = controller_->exchange(now);
    ring_.write(Exchange{now, frame, ring_.machine_state(), ring_.line(), status});
    return status;
  }
  [[nodiscard]] std::uint64_t next_frame() const override { return controller_->next_frame(); }

  [[nodiscard]] std::size_t free_segments() const override { return controller_->free_segments(); }
  std::size_t push(std::span<const Segment> segments) override {
    const std::size_t taken = controller_->push(segments);
    for (const Segment& segment : segments.first(taken)) ring_.write(segment);
    return taken;
  }
  void cut_behind(std::uint32_t id) override {
    ring_.write(CutBehind{id});
    controller_->cut_behind(id);
  }

  void set_outputs(const Outputs& outputs) override {
    ring_.write(SetOutputs{outputs});
    controller_->set_outputs(outputs);
  }
  bool change_outputs(const OutputChange& change) override {
    const bool taken = controller_->change_outputs(change);
    if (taken) ring_.write(ChangeOutputs{change});
    return taken;
  }
  void quick_stop() override {
    ring_.write(QuickStop{});
    controller_->quick_stop();
  }
  void stop_along_path() override {
    ring_.write(StopAlongPath{});
    controller_->stop_along_path();
  }
  void release_stop() override {
    ring_.write(ReleaseStop{});
    controller_->release_stop();
  }
  void clear_faults() override {
    ring_.write(ClearFaults{});
    controller_->clear_faults();
  }
  bool set_position(Axis axis, double position) override {
    const bool done = controller_->set_position(axis, position);
    if (done) ring_.write(SetPosition{axis, position});
    return done;
  }

  void arm_home_latch(Axis axis, LatchEdge edge) override {
    ring_.write(ArmHomeLatch{axis, edge});
    controller_->arm_home_latch(axis, edge);
  }
  void disarm_home_latch(Axis axis) override {
    ring_.write(DisarmHomeLatch{axis});
    controller_->disarm_home_latch(axis);
  }
  void arm_probe_latch() override {
    ring_.write(ArmProbeLatch{});
    controller_->arm_probe_latch();
  }
  void disarm_probe_latch() override {
    ring_.write(DisarmProbeLatch{});
    controller_->disarm_probe_latch();
  }

 private:
  std::unique_ptr<Controller> controller_;
  Ring& ring_;
};

}  // namespace cnc::hal::trace
