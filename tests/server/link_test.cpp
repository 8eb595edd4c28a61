// The passage from the machine to the board (LNK-2, LNK-4, LNK-8).
#include "server/link/link.h"

#include <catch2/catch.hpp>

#include "tests/server/recording_controller.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using Calls = std::vector<std::string>;

namespace {

struct Fixture {
  Recording recording;
  Link link{std::make_unique<RecordingController>(recording)};

  void push_segments(std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t id = first; id <= last; ++id)
      REQUIRE(link.push(hal::Segment{.id = id, .duration = 0.005}));
  }
};

}  // namespace

TEST_CASE("Items reach the board in the order in which they were pushed", "[LNK-2]") {
  Fixture f;
  f.push_segments(1, 2);
  f.link.push(SetOutputs{{.spindle_on = true}});
  f.push_segments(3, 3);
  f.link.push(SetPosition{.axes = {{true, false, true, false, false, false}}, .position = {}});
  f.link.push(ArmLatch{Axis::Y, hal::LatchEdge::release});
  f.link.push(DisarmLatch{Axis::Y});
  f.link.cycle(0.0);
  CHECK(f.recording.calls == Calls{"segment 1", "segment 2", "spindle on", "segment 3",
                                   "position X", "position Z", "arm Y", "disarm Y"});
  CHECK(f.link.status().items_done == f.link.pushed());
}

TEST_CASE("What the board has no room for waits, and nothing overtakes it", "[LNK-2]") {
  Fixture f;
  f.recording.room = 2;
  f.push_segments(1, 4);
  f.link.push(SetOutputs{{.spindle_on = true}});
  f.link.cycle(0.0);
  CHECK(f.recording.calls == Calls{"segment 1", "segment 2"});
  CHECK(f.link.status().items_done == 2);
  f.recording.room = 10;
  f.link.cycle(0.002);
  CHECK(f.recording.calls ==
        Calls{"segment 1", "segment 2", "segment 3", "segment 4", "spindle on"});
  CHECK(f.link.status().items_done == 5);
}

TEST_CASE("What is held back goes out together when it is handed over, or is dropped",
          "[LNK-2][safety]") {
  Fixture f;
  f.push_segments(1, 1);
  f.link.hold_back();
  f.push_segments(2, 3);
  f.link.push(SetOutputs{{.spindle_on = true}});
  f.link.cycle(0.0);
  CHECK(f.recording.calls == Calls{"segment 1"});
  CHECK(f.link.status().items_done == 1);
  SECTION("handed over") {
    f.link.hand_over();
    f.push_segments(4, 4);
    f.link.cycle(0.002);
    CHECK(f.recording.calls ==
          Calls{"segment 1", "segment 2", "segment 3", "spindle on", "segment 4"});
  }
  SECTION("a quick stop") {
    f.link.quick_stop();
    f.push_segments(4, 4);
    f.link.cycle(0.002);
    CHECK(f.recording.calls == Calls{"segment 1", "quick stop", "segment 4"});
  }
  CHECK(f.link.status().items_done == f.link.pushed());
}

TEST_CASE("A quick stop overtakes everything, and what it dropped counts as done",
          "[LNK-8][safety]") {
  Fixture f;
  f.push_segments(1, 100);
  f.link.quick_stop();
  f.link.cycle(0.0);
  CHECK(f.recording.calls == Calls{"quick stop"});
  CHECK(f.link.status().items_done == f.link.pushed());
  f.push_segments(101, 101);
  f.link.cycle(0.002);
  CHECK(f.recording.calls == Calls{"quick stop", "segment 101"});
}

TEST_CASE("What is asked for behind a quick stop is done, before the link has seen the stop too",
          "[LNK-8][safety]") {
  Fixture f;
  REQUIRE(f.link.push(SetOutputs{{.spindle_on = true}}));
  f.push_segments(1, 3);
  f.link.quick_stop();
  REQUIRE(f.link.push(SetOutputs{{.spindle_on = false}}));
  f.link.cycle(0.0);
  CHECK(f.recording.calls == Calls{"quick stop", "spindle off"});
  CHECK(f.link.status().items_done == f.link.pushed());
}

TEST_CASE(
    "A cut travels with the new segments; those that it replaces reach the board before it, as far "
    "as there is room: it may be late",
    "[LNK-8][JOB-8]") {
  Fixture f;
  f.recording.room = 2;
  f.push_segments(1, 6);
  f.link.cycle(0.0);
  f.link.push(SetOutputs{{.spindle_on = true}});
  REQUIRE(f.link.begin_cut(4));
  f.push_segments(101, 102);
  f.link.commit_cut();
  f.push_segments(103, 103);
  const Calls kept{"segment 1", "segment 2", "segment 3", "segment 4"};
  const Calls replaced{"segment 5", "segment 6"};
  const Calls with_the_cut{"spindle on", "cut behind 4"};
  const Calls behind{"segment 101", "segment 102", "segment 103"};
  Calls expected = kept;
  const auto expect = [&](const Calls& calls) {
    expected.insert(expected.end(), calls.begin(), calls.end());
  };
  SECTION("room for all") {
    f.recording.room = 10;
    f.link.cycle(0.002);
    expect(replaced);
    expect(with_the_cut);
    expect(behind);
    CHECK(f.recording.calls == expected);
    CHECK(f.link.status().interval == Approx(0.002));
  }
  SECTION("room for what is kept only: the cut makes some") {
    f.recording.room = 2;
    f.link.cycle(0.002);
    expect(with_the_cut);
    CHECK(f.recording.calls == expected);
    f.recording.room = 10;
    f.link.cycle(0.004);
    expect(behind);
    CHECK(f.recording.calls == expected);
  }
  CHECK(f.link.status().items_done == f.link.pushed());
}

TEST_CASE("A cut replaces what is behind it where the numbers go round too", "[LNK-8][JOB-8]") {
  Fixture f;
  f.recording.room = 1;
  f.push_segments(0xFFFF'FFFEU, 0xFFFF'FFFEU);
  REQUIRE(f.link.push(hal::Segment{.id = 0xFFFF'FFFFU, .duration = 0.005}));
  f.push_segments(1, 2);
  f.link.cycle(0.0);
  REQUIRE(f.link.begin_cut(0xFFFF'FFFEU));
  f.push_segments(3, 3);
  f.link.commit_cut();
  f.link.cycle(0.002);
  f.recording.room = 10;
  f.link.cycle(0.004);
  CHECK(f.recording.calls == Calls{"segment 4294967294", "cut behind 4294967294", "segment 3"});
}

TEST_CASE("Behind a segment that a cut has dropped the board gets none of the old path",
          "[LNK-8][JOB-8][safety]") {
  Fixture f;
  f.recording.room = 2;
  f.push_segments(1, 3);
  REQUIRE(f.link.push(ChangeOutputs{{.flood = true}}));
  f.push_segments(4, 5);
  REQUIRE(f.link.begin_cut(1));
  f.push_segments(101, 101);
  f.link.commit_cut();
  // 3 is dropped; what it waits behind then keeps 4 for the next cycle, in which there is room.
  f.recording.takes_changes = false;
  f.link.cycle(0.0);
  CHECK(f.recording.calls == Calls{"segment 1", "segment 2"});
  f.recording.takes_changes = true;
  f.recording.room = 10;
  f.link.cycle(0.002);
  CHECK(f.recording.calls ==
        Calls{"segment 1", "segment 2", "flood on", "cut behind 1", "segment 101"});
  CHECK(f.link.status().given_before_cut == 2);
  // The next cut is another: what it replaces reaches the board again.
  f.push_segments(102, 103);
  REQUIRE(f.link.begin_cut(101));
  f.link.commit_cut();
  f.link.cycle(0.004);
  CHECK(f.recording.calls.back() == "cut behind 101");
  CHECK(f.link.status().given_before_cut == 103);
}

TEST_CASE("Before it is committed a cut and what follows it wait, the old path goes on",
          "[LNK-8][JOB-8]") {
  Fixture f;
  f.push_segments(1, 3);
  REQUIRE(f.link.begin_cut(1));
  f.push_segments(101, 101);
  f.link.cycle(0.0);
  CHECK(f.recording.calls == Calls{"segment 1", "segment 2", "segment 3"});
  f.link.commit_cut();
  f.link.cycle(0.002);
  CHECK(f.recording.calls ==
        Calls{"segment 1", "segment 2", "segment 3", "cut behind 1", "segment 101"});
}

TEST_CASE("A cut that a quick stop has dropped leaves nothing behind", "[LNK-8][safety]") {
  Fixture f;
  f.push_segments(1, 3);
  REQUIRE(f.link.begin_cut(1));
  f.push_segments(101, 101);
  f.link.quick_stop();
  f.link.cycle(0.0);
  f.link.commit_cut();  // the executor did not know yet
  f.push_segments(201, 202);
  f.link.cycle(0.002);
  CHECK(f.recording.calls == Calls{"quick stop", "segment 201", "segment 202"});
}

TEST_CASE("A board in fault gets nothing but the order to clear it", "[LNK-4][safety]") {
  Fixture f;
  f.recording.room = 0;
  f.recording.status.faults = static_cast<hal::Faults>(hal::Fault::estop);
  f.push_segments(1, 3);
  f.link.push(SetOutputs{{.spindle_on = true}});
  f.link.push(ClearFaults{});
  f.link.cycle(0.0);
  CHECK(f.recording.calls == Calls{"clear faults"});
  CHECK(f.link.status().items_done == f.link.pushed());
  CHECK(f.link.status().board.faults == static_cast<hal::Faults>(hal::Fault::estop));
}

TEST_CASE("A full queue refuses an item and loses none", "[LNK-2]") {
  Fixture f;
  f.recording.room = 0;
  std::uint32_t id = 0;
  while (f.link.push(hal::Segment{.id = id + 1, .duration = 0.005})) ++id;
  CHECK(id == Link::kCapacity);
  CHECK(f.link.space() == 0);
  CHECK(f.link.pushed() == id);
  f.recording.room = 2 * Link::kCapacity;
  f.link.cycle(0.0);
  CHECK(f.recording.calls.size() == id);
  CHECK(f.recording.calls.back() == "segment " + std::to_string(id));
}

TEST_CASE("The lowest FIFO time is that of a board in motion with more to come", "[LNK-2]") {
  Fixture f;
  const auto& lowest = f.link.statistics().lowest_fifo_time;
  f.recording.status.fifo_time = 0.001;  // at rest: does not count
  f.link.cycle(0.0);
  CHECK(lowest == LinkStatistics::kNeverMoved);
  f.recording.status.moving = true;
  f.recording.status.fifo_count = 5;
  for (const double time : {0.2, 0.15, 0.18}) {
    f.recording.status.fifo_time = time;
    f.link.cycle(0.0);
  }
  CHECK(lowest == 0.15);
  f.recording.status.fifo_count = 0;  // the last segment of all
  f.recording.status.fifo_time = 0.002;
  f.link.cycle(0.0);
  CHECK(lowest == 0.15);
}

TEST_CASE("A histogram puts each time under the first edge above it", "[LNK-2]") {
  TimeHistogram histogram;
  CHECK(TimeHistogram::upper_edge(0) == 1e-6);
  CHECK(TimeHistogram::upper_edge(1) == 2e-6);
  CHECK(TimeHistogram::upper_edge(10) == Approx(1.024e-3));
  CHECK(std::isinf(TimeHistogram::upper_edge(TimeHistogram::kBins - 1)));
  for (const double time : {0.0, 0.5e-6, 1e-6, 1.9e-6, 1e-3, 100.0}) histogram.record(time);
  CHECK(histogram.count(0) == 2);
  CHECK(histogram.count(1) == 2);  // an edge belongs to the bin above it
  CHECK(histogram.count(10) == 1);
  CHECK(histogram.count(TimeHistogram::kBins - 1) == 1);
  CHECK(histogram.max() == 100.0);
  CHECK(histogram.mean() == Approx((100.0 + 1e-3 + 3.4e-6) / 6.0));
  histogram.reset();
  for (std::size_t bin = 0; bin < TimeHistogram::kBins; ++bin) CHECK(histogram.count(bin) == 0);
  CHECK(histogram.max() == 0.0);
  CHECK(histogram.mean() == 0.0);
}

TEST_CASE("The FIFO histogram counts exchanges in motion by the seconds left in the board",
          "[LNK-2]") {
  Fixture f;
  const FifoHistogram& fifo = f.link.statistics().fifo_time;
  // An exchange for each: only the last three are in motion with more to come.
  struct Row {
    bool moving;
    std::uint32_t count;
    double time;
  };
  for (const Row& row :
       {Row{false, 0, 0.0}, {true, 0, 0.004}, {true, 9, 0.0005}, {true, 9, 0.24}, {true, 9, 5.0}}) {
    f.recording.status.moving = row.moving;
    f.recording.status.fifo_count = row.count;
    f.recording.status.fifo_time = row.time;
    f.link.cycle(0.0);
  }
  for (std::size_t bin = 0; bin < FifoHistogram::kBins; ++bin) {
    const double upper = FifoHistogram::upper_edge(bin);
    const bool expected = upper == 0.001 || upper == 0.25 || std::isinf(upper);
    CAPTURE(upper);
    CHECK(fifo.count(bin) == (expected ? 1 : 0));
  }
  CHECK(fifo.mean() == Approx((0.0005 + 0.24 + 5.0) / 3.0));
  f.link.statistics().ask_for_reset();
  f.recording.status.moving = false;
  f.link.cycle(0.0);
  CHECK(fifo.max() == 0.0);
}

TEST_CASE("Round trips are counted when an answer has come; packets since the last reset",
          "[LNK-2]") {
  Fixture f;
  LinkStatistics& statistics = f.link.statistics();
  hal::ControllerStatus& board = f.recording.status;
  f.link.cycle(0.0);  // nothing has come yet
  CHECK(statistics.round_trip.max() == 0.0);
  board.packets = {.sent = 10, .resent = 1, .answered = 7, .passed_over = 2, .corrupted = 3};
  board.round_trip = 0.001;
  f.link.cycle(0.002);
  f.link.cycle(0.004);  // silence
  board.packets.answered = 8;
  board.round_trip = 0.003;
  f.link.cycle(0.006);
  CHECK(statistics.round_trip.mean() == Approx(0.002));
  CHECK(statistics.round_trip.max() == 0.003);
  CHECK(statistics.last_round_trip == 0.003);

  statistics.ask_for_reset();
  CHECK(statistics.packets().sent == 10);  // until the link thread comes to it
  board.packets = {.sent = 15, .resent = 3, .answered = 12, .passed_over = 2, .corrupted = 4};
  f.link.cycle(0.008);
  const hal::PacketCounts since = statistics.packets();
  CHECK(since.sent == 5);
  CHECK(since.resent == 2);
  CHECK(since.answered == 4);
  CHECK(since.passed_over == 0);
  CHECK(since.corrupted == 1);
}
