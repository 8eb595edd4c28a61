// The interpreter's whole state: modes, position and offsets. A plain value, so that a line that is
// refused half-way is undone by putting back the copy of before: of all of it, or for a plain line,
// which would take longer to copy than to execute, of the little that such a line can change.
#pragma once

#include "config/axis.h"
#include "config/parameter_store.h"
#include "config/tool_table.h"
#include "interpreter/answer.h"
#include "interpreter/cutter_compensation.h"
#include "interpreter/modal_state.h"
#include "interpreter/xy_transform.h"

namespace cnc::interp {

/// machine = rotated and scaled work + work offset + G92 offset + tool length + offset of the head
/// (manual 3.1.3, 3.4.5, 3.4.12, 3.4.13, 3.4.18, 3.4.23, 3.5.2).
class WorkCoordinates {
 public:
  [[nodiscard]] const Position& work_offset() const { return work_offset_; }
  [[nodiscard]] const Position& g92_offset() const { return g92_offset_; }
  [[nodiscard]] const Position& tool_length() const { return tool_length_; }
  [[nodiscard]] const Position& head_offset() const { return head_offset_; }
  [[nodiscard]] const Position& total() const { return total_; }

  [[nodiscard]] Position to_machine(const Position& work) const {
    return transform_.apply(work) + total_;
  }
  [[nodiscard]] Position to_work(const Position& machine) const {
    return transform_.undo(machine - total_);
  }

  [[nodiscard]] const XyTransform& transform() const { return transform_; }
  [[nodiscard]] XyTransform& transform() { return transform_; }

  void set_work_offset(const Position& offset);
  void set_g92_offset(const Position& offset);
  /// Along X (turning) and Z.
  void set_tool_length(double x, double z);
  void set_head_offset(const Position& offset);

  friend bool operator==(const WorkCoordinates&, const WorkCoordinates&) = default;

 private:
  void sum_up() { total_ = work_offset_ + g92_offset_ + tool_length_ + head_offset_; }

  Position work_offset_;
  Position g92_offset_;
  Position tool_length_;
  Position head_offset_;
  Position total_;  ///< of the four offsets
  XyTransform transform_;
};

/// Words of a canned cycle that stay for the lines that follow it (manual 3.4.21): lengths in mm.
struct CycleWords {
  double bottom = 0.0;   ///< Z in the XY plane
  double retract = 0.0;  ///< R
  double peck = 0.0;     ///< Q
  double dwell = 0.0;    ///< P, s
  double pitch = 0.0;    ///< F of G74 and G84, per revolution
  double back = 0.0;     ///< K of G87 in the XY plane: up to where it bores
  /// I and J of G87: from the hole to where the tool fits through, along the plane's axes.
  double insert_first = 0.0;
  double insert_second = 0.0;
  /// What the numbers were written for; in another plane or distance mode they mean nothing.
  Plane plane = Plane::xy;
  DistanceMode distance = DistanceMode::absolute;

  friend bool operator==(const CycleWords&, const CycleWords&) = default;
};

/// What F and G0 to G3 change while cutter compensation is off.
struct PlainState {
  Position position;
  std::int32_t motion = 0;
  double feed = 0.0;
  double linear_feed = 0.0;
  double rotary_feed = 0.0;
};

struct MachineState {
  ModalState modal;
  WorkCoordinates coordinates;
  CycleWords cycle;  ///< as modal.motion last had it, if that is a canned cycle
  CutterCompensation compensation;
  Position position;                  ///< machine coordinates that the program has reached
  LiveValues live;                    ///< as the last answer gave them
  bool rendering = false;             ///< #5397: nothing moves, everything goes as programmed
  bool diameter_programming = false;  ///< X words are diameters

  /// Where the commands so far take the machine: beside `position` under cutter compensation.
  [[nodiscard]] Position machine_position() const;
  /// The machine stands here now.
  void arrive(const Position& machine);

  [[nodiscard]] PlainState plain() const {
    return {position, modal.motion, modal.feed, modal.linear_feed, modal.rotary_feed};
  }
  void put_back(const PlainState& before);

  [[nodiscard]] Position work_position() const { return coordinates.to_work(position); }
  /// Program units of an axis word to mm or degrees: inches exist for X Y Z only, diameters for X.
  [[nodiscard]] double scale(Axis axis) const {
    if (is_rotary(axis)) return 1.0;
    const bool halves = axis == Axis::X && diameter_programming;
    return halves ? millimetres_per(modal.unit) / 2.0 : millimetres_per(modal.unit);
  }
  /// Of other lengths: I J K R are never diameters.
  [[nodiscard]] double scale() const { return millimetres_per(modal.unit); }

  friend bool operator==(const MachineState&, const MachineState&) = default;
};

}  // namespace cnc::interp
