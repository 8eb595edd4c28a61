#include "server/machine/message_log.h"

#include <catch2/catch.hpp>

using namespace cnc;
using namespace cnc::server;

TEST_CASE("Messages are numbered from 1 and given from any number on", "[messages]") {
  MessageLog log;
  CHECK(log.newest() == 0);
  for (const char* text : {"one", "two", "three"}) log.add(Severity::info, text);
  CHECK(log.newest() == 3);
  const auto all = log.after(0);
  REQUIRE(all.size() == 3);
  CHECK(all[0].sequence == 1);
  CHECK(all[0].text == "one");
  const auto last = log.after(2);
  REQUIRE(last.size() == 1);
  CHECK(last[0].text == "three");
  CHECK(log.after(3).empty());
}

TEST_CASE("A limit gives the newest messages, oldest first", "[messages]") {
  MessageLog log;
  for (const char* text : {"one", "two", "three"}) log.add(Severity::warning, text);
  const auto newest = log.after(0, 2);
  REQUIRE(newest.size() == 2);
  CHECK(newest[0].text == "two");
  CHECK(newest[1].text == "three");
}

TEST_CASE("Only the last 1000 messages are kept", "[messages]") {
  MessageLog log;
  for (int i = 1; i <= 1500; ++i) log.add(Severity::info, std::to_string(i));
  const auto kept = log.after(0);
  REQUIRE(kept.size() == 1000);
  CHECK(kept.front().sequence == 501);
  CHECK(kept.back().text == "1500");
  CHECK(log.newest() == 1500);
}

TEST_CASE("An error keeps its code and place", "[messages][LNG-10]") {
  MessageLog log;
  log.add(Error{ErrorCode::travel_limit, "Too far.", TextPlace{"a.nc", 7, 3}});
  const auto messages = log.after(0);
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].severity == Severity::error);
  REQUIRE(messages[0].error);
  CHECK(messages[0].error->code == ErrorCode::travel_limit);
  CHECK(messages[0].error->place->line == 7);
  CHECK(messages[0].text == "a.nc:7:3: Too far. [E5005]");
}
