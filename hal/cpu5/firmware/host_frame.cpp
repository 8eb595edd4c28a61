#include "hal/cpu5/firmware/host_frame.h"

namespace cnc::hal::cpu5::firmware {
namespace {

void execute_latch(LatchRequest request, std::size_t axis, Core& core) {
  switch (request) {
    case LatchRequest::none:
      return;
    case LatchRequest::arm_activate:
      return core.arm_latch(axis, Edge::activate);
    case LatchRequest::arm_release:
      return core.arm_latch(axis, Edge::release);
    case LatchRequest::disarm:
      return core.disarm_latch(axis);
  }
}

void execute_probe(ProbeRequest request, Core& core) {
  switch (request) {
    case ProbeRequest::none:
      return;
    case ProbeRequest::arm:
      return core.arm_probe();
    case ProbeRequest::disarm:
      return core.disarm_probe();
  }
}

void push_segments(const HostFrame& frame, std::uint32_t first, std::uint32_t end, Core& core) {
  for (std::uint32_t i = first; i < end; ++i) {
    if (!core.push(frame.segments[i])) return;
  }
}

}  // namespace

void HostFrame::reset() {
  quick_stop = false;
  clear_faults = false;
  release_stop = false;
  stop_along_path = false;
  latch = {};
  probe = ProbeRequest::none;
  with_next = false;
  drop_path_and_outputs();
}

void HostFrame::drop_path_and_outputs() {
  has_outputs = false;
  change = {};
  has_cut = false;
  segment_count = 0;
}

void execute(const HostFrame& frame, Core& core) {
  core.host_alive();
  if (frame.quick_stop) core.quick_stop();
  if (frame.clear_faults) core.clear_faults();
  if (frame.release_stop) core.release_stop();
  if (frame.stop_along_path) core.stop_along_path();
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    execute_latch(frame.latch[axis], axis, core);
  }
  execute_probe(frame.probe, core);
  if (frame.has_outputs) core.set_outputs(frame.outputs);
  if (!frame.change.empty()) core.change_outputs(frame.change);
  const std::uint32_t count =
      frame.segment_count < kSegmentsPerFrame ? frame.segment_count : kSegmentsPerFrame;
  const std::uint32_t before_cut = frame.has_cut ? frame.segments_before_cut : count;
  push_segments(frame, 0, before_cut, core);
  if (!frame.has_cut) return;
  core.cut_behind(frame.cut_behind);
  push_segments(frame, before_cut, count, core);
}

}  // namespace cnc::hal::cpu5::firmware
