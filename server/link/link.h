// The passage between the machine (executor thread) and the controller board (link thread).
//
// The executor pushes items: segments and commands, in the order in which they have to happen. The
// link thread calls cycle() at a fixed pace: it moves items to the board as far as the board takes
// them, exchanges, and publishes the board's status. Neither side waits for the other: what must
// not reach the board in parts is held back until it is whole. cncsim and tests call both sides
// from one thread.
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <memory>
#include <variant>

#include "hal/controller.h"
#include "server/link/link_statistics.h"
#include "server/link/triple_buffer.h"

namespace cnc::server {

struct SetOutputs {
  hal::Outputs outputs;
};
/// At once, whatever moves.
struct ChangeOutputs {
  hal::OutputChange change;
};
struct ClearFaults {};
struct SetPosition {
  AxisArray<bool> axes{};
  Position position;
};
struct ArmLatch {
  Axis axis = Axis::X;
  hal::LatchEdge edge = hal::LatchEdge::activate;
};
struct DisarmLatch {
  Axis axis = Axis::X;
};
struct ArmProbe {};
struct DisarmProbe {};
/// Ends a stop along the path: segments pushed before it are void, those behind it are taken.
struct ReleaseStop {};

/// What follows is meant for the board in this session. Items pushed before, for a session that has
/// ended, are dropped.
struct JoinSession {
  std::uint32_t session = 0;
};

/// The segments that follow replace those behind segment `id`; by Link::begin_cut() only.
struct CutBehind {
  std::uint32_t id = 0;
};

using LinkItem =
    std::variant<hal::Segment, SetOutputs, ChangeOutputs, ClearFaults, SetPosition, ArmLatch,
                 DisarmLatch, ArmProbe, DisarmProbe, ReleaseStop, CutBehind, JoinSession>;

struct LinkStatus {
  hal::ControllerStatus board;
  /// Items that have reached the board, since the link was made; `board` shows what came of them.
  std::uint64_t items_done = 0;
  /// Id of the last segment that the board had been given when the last cut was: should that be
  /// late, the path that the board goes on with ends there.
  std::uint32_t given_before_cut = 0;
  double interval = 0.0;  ///< s between the last two exchanges
};

class Link {
 public:
  static constexpr std::size_t kCapacity = 4096;

  explicit Link(std::unique_ptr<hal::Controller> controller);

  // --- executor thread -----------------------------------------------------------------------

  /// False when the queue is full: try again in the next cycle.
  bool push(const LinkItem& item);
  [[nodiscard]] std::size_t space() const { return queue_.write_available(); }
  /// Number of items pushed so far; when status().items_done reaches it the board has them all.
  [[nodiscard]] std::uint64_t pushed() const { return pushed_; }
  /// What is pushed from now on waits for hand_over(), and then goes out together.
  void hold_back() { holds_back_ = true; }
  void hand_over();
  /// Replaces the segments behind number `id`, those that still wait here too: begin_cut(), push
  /// the new ones, commit_cut(). Cut and new segments are held back until then; what they replace
  /// goes before them as far as the board has room, and is dropped where it has none. When the item
  /// that begin_cut() has pushed is done, the status says whether it was late, and what the board
  /// has of the old path then. One at a time.
  bool begin_cut(std::uint32_t id);
  void commit_cut();
  /// Overtakes everything: pulses stop at once, items pushed before are dropped (and count as
  /// done), outputs among them. Those that are pushed from now on happen behind it.
  void quick_stop();
  [[nodiscard]] const LinkStatus& status() { return status_.read(); }

  // --- link thread: real-time, no allocation, no lock --------------------------------------------

  void cycle(double now);

  // --- any thread --------------------------------------------------------------------------------

  [[nodiscard]] LinkStatistics& statistics() { return statistics_; }

 private:
  void deliver();
  /// Whether it leaves the queue: delivered, or cut off.
  bool dispose_of(const LinkItem& item);
  /// False when the board has no room for it yet.
  bool deliver(const LinkItem& item);
  [[nodiscard]] bool is_replaced(const LinkItem& item) const;
  void drop_queue();
  void drop_front();
  void note_delivered();
  void note_done(std::uint64_t frames_done);

  /// How many items had been handed over with a frame of the controller's.
  struct Delivery {
    std::uint64_t frame = 0;
    std::uint64_t items = 0;
  };
  static constexpr std::size_t kDeliveries = 64;  // more than frames can be on their way

  std::unique_ptr<hal::Controller> controller_;
  boost::lockfree::spsc_queue<LinkItem, boost::lockfree::capacity<kCapacity>> queue_;
  TripleBuffer<LinkStatus> status_;
  std::atomic<std::uint64_t> handed_over_{0};        // number of the last item that may go out
  std::atomic<std::uint64_t> quick_stop_before_{0};  // number of the next item; 0: none is wanted
  std::atomic<std::uint64_t> cut_item_{0};  // number of the last cut that is committed, among items
  std::atomic<std::uint32_t> cut_behind_{0};
  std::uint64_t pushed_ = 0;      // executor's
  bool holds_back_ = false;       // executor's
  std::uint64_t begun_cut_ = 0;   // executor's: number of its item
  double last_exchange_ = 0.0;    // link thread's
  std::uint64_t delivered_ = 0;   // link thread's, as all that follows: items handed over
  std::uint64_t items_done_ = 0;  // and those that the board has answered
  std::array<Delivery, kDeliveries> deliveries_{};  // by frame
  std::uint32_t session_ = 0;                       // with the board, as last heard
  std::uint32_t joined_session_ = 0;                // that the items in the queue are meant for
  std::uint64_t frames_done_ = 0;
  std::uint64_t settling_frame_ = 0;  // clears faults or releases a stop: older status is past
  bool path_is_void_ = false;         // the board has stopped along the path: no segment reaches it
  std::uint32_t given_id_ = 0;        // of the last segment that the controller took
  std::uint32_t given_before_cut_ = 0;
  std::uint64_t shortened_by_ = 0;  // number of the cut that has dropped segments in the queue
  LinkStatistics statistics_;
};

}  // namespace cnc::server
