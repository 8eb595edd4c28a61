#include "server/link/link.h"

#include <algorithm>
#include <utility>

#include "hal/counting_round.h"

namespace cnc::server {

Link::Link(std::unique_ptr<hal::Controller> controller) : controller_(std::move(controller)) {}

bool Link::push(const LinkItem& item) {
  if (!queue_.push(item)) return false;
  ++pushed_;
  if (!holds_back_) hand_over();
  return true;
}

void Link::hand_over() {
  holds_back_ = false;
  handed_over_.store(pushed_, std::memory_order_release);
}

bool Link::begin_cut(std::uint32_t id) {
  hold_back();
  if (!push(CutBehind{id})) return false;
  begun_cut_ = pushed_;
  cut_behind_.store(id, std::memory_order_relaxed);
  return true;
}

void Link::commit_cut() {
  cut_item_.store(begun_cut_, std::memory_order_release);
  hand_over();
}

void Link::quick_stop() {
  quick_stop_before_.store(pushed_ + 1, std::memory_order_release);
  hand_over();  // only then: what is dropped must not go out before
}

void Link::cycle(double now) {
  if (const auto before = quick_stop_before_.exchange(0, std::memory_order_acq_rel); before != 0) {
    controller_->quick_stop();
    while (delivered_ + 1 < before && queue_.read_available() > 0) drop_front();
  }
  deliver();
  LinkStatus& status = status_.back();
  status.board = controller_->exchange(now);
  // A board in fault takes nothing; what was meant for it would be wrong after the fault is
  // cleared. Nor does one that is not there.
  if (status.board.sessions != session_) settling_frame_ = 0;
  session_ = status.board.sessions;
  const bool settled = status.board.frames_done >= settling_frame_;
  if (!status.board.connected || (settled && status.board.faults != 0)) drop_queue();
  path_is_void_ = settled && status.board.path_stop == hal::PathStop::stopped;
  note_done(status.board.frames_done);
  status.items_done = items_done_;
  status.given_before_cut = given_before_cut_;
  status.interval = now - std::exchange(last_exchange_, now);
  statistics_.note(status.board);
  status_.publish();
}

/// The board may have been reset, or have gone on, between two sessions: what was meant for the one
/// before would begin at another place.
void Link::deliver() {
  while (session_ != joined_session_ && queue_.read_available() > 0) drop_front();
  // Behind a quick stop that has come meanwhile: with the next cycle's frame, which knows of it.
  const auto may_deliver = [this] {
    return delivered_ < handed_over_.load(std::memory_order_acquire) &&
           quick_stop_before_.load(std::memory_order_acquire) == 0;
  };
  while (may_deliver() && dispose_of(queue_.front())) {
    queue_.pop();
    note_delivered();
  }
}

/// It goes out with the controller's next frame.
void Link::note_delivered() {
  const std::uint64_t frame = controller_->next_frame();
  deliveries_[frame % kDeliveries] = {frame, ++delivered_};
}

void Link::note_done(std::uint64_t frames_done) {
  const std::uint64_t first =
      std::max(frames_done_, frames_done < kDeliveries ? 0 : frames_done - kDeliveries + 1);
  for (std::uint64_t frame = first; frame <= frames_done; ++frame) {
    const Delivery& delivery = deliveries_[frame % kDeliveries];
    if (delivery.frame == frame) items_done_ = delivery.items;
  }
  frames_done_ = frames_done;
  const bool all_answered = frames_done + 1 >= controller_->next_frame();
  if (all_answered) items_done_ = delivered_;
}

/// By a cut behind it in the queue. The number of the cut is loaded first: what it cuts behind was
/// stored before.
bool Link::is_replaced(const LinkItem& item) const {
  const auto* segment = std::get_if<hal::Segment>(&item);
  return segment != nullptr && delivered_ < cut_item_.load(std::memory_order_acquire) &&
         hal::is_newer(segment->id, cut_behind_.load(std::memory_order_relaxed));
}

/// A segment that is replaced must not hold up the cut where the board has no room. Where there is
/// room the board gets it: should the cut be late, the path goes on with it. But none behind one
/// that was dropped: the board would take the gap for a fault.
bool Link::dispose_of(const LinkItem& item) {
  const bool replaced = is_replaced(item);
  const std::uint64_t cut = cut_item_.load(std::memory_order_relaxed);
  if (replaced && shortened_by_ == cut) return true;
  if (deliver(item)) return true;
  if (replaced) shortened_by_ = cut;
  return replaced;
}

bool Link::deliver(const LinkItem& item) {
  struct Visitor {
    hal::Controller& board;
    bool& path_is_void;
    std::uint64_t& settling_frame;
    std::uint32_t& given_id;
    std::uint32_t& given_before_cut;
    bool operator()(const hal::Segment& segment) const {
      if (path_is_void) return true;
      if (board.push({&segment, 1}) != 1) return false;
      given_id = segment.id;
      return true;
    }
    bool operator()(const CutBehind& cut) const {
      board.cut_behind(cut.id);
      given_before_cut = given_id;
      return true;
    }
    bool operator()(const JoinSession&) const { return true; }
    bool operator()(const ArmProbe&) const {
      board.arm_probe_latch();
      return true;
    }
    bool operator()(const DisarmProbe&) const {
      board.disarm_probe_latch();
      return true;
    }
    bool operator()(const ReleaseStop&) const {
      board.release_stop();
      settling_frame = board.next_frame();
      path_is_void = false;
      return true;
    }
    bool operator()(const SetOutputs& set) const {
      board.set_outputs(set.outputs);
      return true;
    }
    bool operator()(const ChangeOutputs& set) const { return board.change_outputs(set.change); }
    bool operator()(const ClearFaults&) const {
      board.clear_faults();
      settling_frame = board.next_frame();
      return true;
    }
    bool operator()(const SetPosition& set) const {
      for (const Axis axis : kAllAxes)
        if (set.axes[axis]) board.set_position(axis, set.position[axis]);
      return true;
    }
    bool operator()(const ArmLatch& arm) const {
      board.arm_home_latch(arm.axis, arm.edge);
      return true;
    }
    bool operator()(const DisarmLatch& disarm) const {
      board.disarm_home_latch(disarm.axis);
      return true;
    }
  };
  return std::visit(
      Visitor{*controller_, path_is_void_, settling_frame_, given_id_, given_before_cut_}, item);
}

void Link::drop_queue() {
  while (queue_.read_available() > 0) drop_front();
}

void Link::drop_front() {
  const LinkItem& item = queue_.front();
  if (const auto* join = std::get_if<JoinSession>(&item)) joined_session_ = join->session;
  // Faults are cleared by an item in this very queue: it must survive, or the machine could never
  // leave the fault.
  if (std::holds_alternative<ClearFaults>(item) && session_ == joined_session_) {
    controller_->clear_faults();
    settling_frame_ = controller_->next_frame();
  }
  queue_.pop();
  note_delivered();
}

}  // namespace cnc::server
