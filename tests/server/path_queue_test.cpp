// The queue between the two threads of a prediction.
#include "server/job/path_queue.h"

#include <catch2/catch.hpp>
#include <future>

using namespace cnc;
using namespace cnc::server;
using namespace std::chrono_literals;

namespace {

constexpr auto kLong = 20s;

motion::Piece piece_of(std::uint64_t move) {
  motion::Piece piece;
  piece.tag.id = move;
  return piece;
}

std::uint64_t move_of(const PathItem& item) {
  const auto* rest = std::get_if<Rest>(&item);
  return rest != nullptr ? rest->move : std::get<motion::Piece>(item).tag.id;
}

}  // namespace

TEST_CASE("Pieces and rests arrive complete and in their order", "[JOB-5][threads]") {
  // None, a part of what travels at once, exactly that, and far more than may wait.
  const std::uint64_t count = GENERATE(0U, 1U, 256U, 257U, 100'000U);
  PathQueue queue;
  auto consumer = std::async(std::launch::async, [&] {
    std::uint64_t received = 0;
    while (const PathItem* item = queue.front()) {
      if (move_of(*item) != received) break;
      ++received;
      queue.pop();
    }
    return received;
  });
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i % 5 == 0) {
      queue.add(Rest{1.0, i});
    } else {
      queue.add(piece_of(i));
    }
  }
  queue.close();
  CHECK(consumer.get() == count);
  CHECK(queue.front() == nullptr);
}

TEST_CASE("What has been popped last stays popped until something comes", "[JOB-5]") {
  PathQueue queue;
  queue.add(piece_of(1));
  queue.close();
  REQUIRE(queue.front() != nullptr);
  CHECK(queue.front() == queue.front());
  queue.pop();
  CHECK(queue.front() == nullptr);
}

TEST_CASE("A producer that waits for room goes on when the queue is abandoned",
          "[JOB-5][threads]") {
  PathQueue queue;
  auto producer = std::async(std::launch::async, [&] {
    for (std::uint64_t i = 0; i < 100'000; ++i) queue.add(piece_of(i));
    queue.close();
  });
  CHECK(producer.wait_for(50ms) == std::future_status::timeout);
  queue.abandon();
  CHECK(producer.wait_for(kLong) == std::future_status::ready);
  CHECK(queue.front() == nullptr);
}

TEST_CASE("A consumer that waits for more goes on when the queue is abandoned",
          "[JOB-5][threads]") {
  PathQueue queue;
  auto consumer = std::async(std::launch::async, [&] { return queue.front(); });
  CHECK(consumer.wait_for(50ms) == std::future_status::timeout);
  queue.abandon();
  REQUIRE(consumer.wait_for(kLong) == std::future_status::ready);
  CHECK(consumer.get() == nullptr);
}
