// A board that does nothing but keep what it is told.
#pragma once

#include <string>
#include <vector>

#include "hal/controller.h"

namespace cnc::server::test {

/// What a RecordingController was told, in order; a test holds it beside the link that owns the
/// board.
struct Recording {
  std::vector<std::string> calls;
  std::size_t room = 1000;    ///< segments that the board still takes
  bool takes_changes = true;  ///< of outputs
  hal::ControllerStatus status;
};

class RecordingController final : public hal::Controller {
 public:
  explicit RecordingController(Recording& recording) : recording_(recording) {
    recording_.status.connected = true;
  }

  Result<hal::Capabilities> connect() override { return {}; }
  void disconnect() override {}
  const hal::ControllerStatus& exchange(double) override { return recording_.status; }
  [[nodiscard]] std::uint64_t next_frame() const override { return 0; }
  [[nodiscard]] std::size_t free_segments() const override { return recording_.room; }
  std::size_t push(std::span<const hal::Segment> segments) override {
    std::size_t taken = 0;
    for (; taken < segments.size() && recording_.room > 0; ++taken, --recording_.room)
      note("segment " + std::to_string(segments[taken].id));
    return taken;
  }
  void cut_behind(std::uint32_t id) override { note("cut behind " + std::to_string(id)); }
  void set_outputs(const hal::Outputs& outputs) override {
    note(outputs.spindle_on ? "spindle on" : "spindle off");
  }
  bool change_outputs(const hal::OutputChange& change) override {
    if (!recording_.takes_changes) return false;
    if (change.flood) note(*change.flood ? "flood on" : "flood off");
    return true;
  }
  void quick_stop() override { note("quick stop"); }
  void stop_along_path() override { note("stop along path"); }
  void release_stop() override { note("release stop"); }
  void clear_faults() override { note("clear faults"); }
  bool set_position(Axis axis, double) override {
    note("position " + std::string(axis_name(axis)));
    return true;
  }
  void arm_home_latch(Axis axis, hal::LatchEdge) override {
    note("arm " + std::string(axis_name(axis)));
  }
  void disarm_home_latch(Axis axis) override { note("disarm " + std::string(axis_name(axis))); }
  void arm_probe_latch() override { note("arm probe"); }
  void disarm_probe_latch() override { note("disarm probe"); }

 private:
  void note(std::string call) { recording_.calls.push_back(std::move(call)); }

  Recording& recording_;
};

}  // namespace cnc::server::test
