// What passes between threads: status, statistics, tasks, the link's pace. Real threads and a real
// clock; every wait is bounded.
#include <atomic>
#include <catch2/catch.hpp>
#include <future>
#include <numeric>
#include <thread>

#include "server/daemon/link_thread.h"
#include "server/daemon/task_thread.h"
#include "server/link/triple_buffer.h"
#include "tests/server/recording_controller.h"

using namespace cnc;
using namespace cnc::server;
using namespace cnc::server::test;
using namespace std::chrono_literals;

namespace {

constexpr auto kLong = 20s;

template <typename Condition>
bool eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + kLong;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

}  // namespace

TEST_CASE("A triple buffer gives whole values, never an older one after a newer one", "[threads]") {
  struct Value {
    std::uint64_t first = 0;
    std::array<std::uint64_t, 30> copies{};
  };
  constexpr std::uint64_t kCount = 200'000;
  TripleBuffer<Value> buffer;
  std::jthread writer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      Value& value = buffer.back();
      value.first = i;
      value.copies.fill(i);
      buffer.publish();
    }
  });
  std::uint64_t last = 0;
  std::uint64_t torn = 0;
  std::uint64_t backwards = 0;
  REQUIRE(eventually([&] {
    const Value& value = buffer.read();
    for (const std::uint64_t copy : value.copies) torn += copy != value.first;
    backwards += value.first < last;
    last = value.first;
    return last == kCount;
  }));
  CHECK(torn == 0);
  CHECK(backwards == 0);
}

TEST_CASE("A triple buffer that nobody wrote to reads as empty, and as the newest later") {
  TripleBuffer<int> buffer;
  CHECK(buffer.read() == 0);
  for (int i = 1; i <= 5; ++i) {
    buffer.back() = i;
    buffer.publish();
  }
  CHECK(buffer.read() == 5);
  CHECK(buffer.read() == 5);
}

TEST_CASE("A histogram that one thread fills is read by another", "[threads]") {
  TimeHistogram histogram;
  constexpr std::uint64_t kCount = 100'000;
  std::jthread writer([&] {
    for (std::uint64_t i = 0; i < kCount; ++i) histogram.record(1e-5 * static_cast<double>(i % 7));
  });
  const auto total = [&] {
    std::uint64_t sum = 0;
    for (std::size_t bin = 0; bin < TimeHistogram::kBins; ++bin) sum += histogram.count(bin);
    return sum;
  };
  REQUIRE(eventually([&] { return total() == kCount; }));
  CHECK(histogram.max() == Approx(6e-5));
}

TEST_CASE("Tasks run one after the other in the order in which they were posted", "[threads]") {
  TaskThread tasks;
  std::vector<int> order;
  std::promise<void> done;
  for (int i = 0; i < 1000; ++i) tasks.post([&order, i] { order.push_back(i); });
  tasks.post([&] { done.set_value(); });
  REQUIRE(done.get_future().wait_for(kLong) == std::future_status::ready);
  std::vector<int> expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  CHECK(order == expected);
}

TEST_CASE("A repeated task runs at its pace until it says that it is over", "[threads]") {
  TaskThread tasks;
  std::promise<void> done;
  int runs = 0;
  const auto begin = std::chrono::steady_clock::now();
  tasks.every(5ms, [&] {
    if (++runs < 10) return true;
    done.set_value();
    return false;
  });
  REQUIRE(done.get_future().wait_for(kLong) == std::future_status::ready);
  // The first at once, nine periods follow.
  CHECK(std::chrono::steady_clock::now() - begin >= 9 * 5ms);
  tasks.stop();
  CHECK(runs == 10);
}

TEST_CASE("After stop() no task begins", "[threads]") {
  TaskThread tasks;
  std::atomic<int> runs{0};
  tasks.every(1ms, [&] {
    ++runs;
    return true;
  });
  REQUIRE(eventually([&] { return runs > 3; }));
  tasks.stop();
  const int at_stop = runs;
  tasks.post([&] { runs = -1; });
  CHECK(runs == at_stop);
}

TEST_CASE("The link thread keeps its pace, counts its cycles and delivers", "[threads][LNK-2]") {
  Recording recording;
  Link link(std::make_unique<RecordingController>(recording));
  {
    const LinkThread thread(link, std::chrono::steady_clock::now(), 1ms);
    link.push(SetOutputs{{.spindle_on = true}});
    REQUIRE(eventually([&] { return link.statistics().cycles >= 50; }));
    REQUIRE(eventually([&] { return link.status().items_done == link.pushed(); }));
  }
  CHECK(recording.calls == std::vector<std::string>{"spindle on"});
  std::uint64_t counted = 0;
  for (std::size_t bin = 0; bin < TimeHistogram::kBins; ++bin)
    counted += link.statistics().lateness.count(bin);
  CHECK(counted == link.statistics().cycles);
  const auto cycles = link.statistics().cycles.load();
  std::this_thread::sleep_for(5ms);
  CHECK(link.statistics().cycles == cycles);  // it has ended
}

TEST_CASE("Whoever resets the statistics of a link at work makes it count nothing wrong",
          "[threads][LNK-2]") {
  LinkStatistics statistics;
  std::atomic<bool> ending{false};
  hal::ControllerStatus board;
  std::thread link([&] {
    while (!ending) {
      ++board.packets.sent;
      ++board.packets.answered;
      statistics.note(board);
      statistics.lateness.record(0.001);
      statistics.cycles.fetch_add(1, std::memory_order_relaxed);
    }
  });
  constexpr std::uint64_t kMore = std::uint64_t{1} << 40;  // than can have been sent by then
  bool plausible = true;
  for (int i = 0; i < 20'000; ++i) {
    statistics.ask_for_reset();
    plausible = plausible && statistics.packets().sent < kMore;
  }
  ending = true;
  link.join();
  CHECK(plausible);
  std::uint64_t counted = 0;
  for (std::size_t bin = 0; bin < TimeHistogram::kBins; ++bin)
    counted += statistics.lateness.count(bin);
  CHECK(counted == statistics.cycles);

  statistics.ask_for_reset();
  ++board.packets.sent;
  statistics.note(board);
  CHECK(statistics.packets().sent == 1);
  CHECK(statistics.cycles == 0);
}
