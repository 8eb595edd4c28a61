// The way to a board that is opened by a thread of its own: real time, real devices.
#include "hal/cpu5/driver/lasting_channel.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <mutex>
#include <unistd.h>

#include "hal/cpu5/driver/board_address.h"
#include "hal/cpu5/driver/udp_channel.h"
#include "hal/cpu5/driver/wire_port.h"
#include "tests/allocations.h"
#include "tests/hal/pretend_board.h"
#include "tests/patience.h"

using namespace cnc;
using namespace cnc::hal;
using namespace cnc::hal::cpu5;
using namespace std::chrono_literals;
using boost::asio::ip::udp;
using Catch::Contains;
using cnc::test::kPatience;

namespace {

template <typename Condition>
bool becomes(Condition condition) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

/// The board's end of a serial line, and a name that leads to the host's.
class Line {
 public:
  explicit Line(std::filesystem::path name) : name_(std::move(name)) {
    board_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    REQUIRE(board_ >= 0);
    REQUIRE(::grantpt(board_) == 0);
    REQUIRE(::unlockpt(board_) == 0);
    std::filesystem::remove(name_);
    std::filesystem::create_symlink(::ptsname(board_), name_);
  }
  ~Line() {
    ::close(board_);
    std::error_code ignored;
    std::filesystem::remove(name_, ignored);
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  [[nodiscard]] bool hears_something() const {
    char byte = 0;
    return ::read(board_, &byte, 1) == 1;
  }

 private:
  std::filesystem::path name_;
  int board_ = -1;
};

std::filesystem::path line_name() {
  return std::filesystem::temp_directory_path() / ("cnc_line_" + std::to_string(::getpid()));
}

/// Attempts of a maker: so many fail first. What a listener heard.
struct Attempts {
  std::mutex mutex;  // protects told
  std::atomic<int> failures{0};
  std::atomic<int> made{0};
  sim::Pretence pretence;
  std::vector<std::string> told;

  LastingChannel::Maker maker() {
    return [this]() -> Result<std::unique_ptr<PacketChannel>> {
      if (failures > 0) {
        --failures;
        return fail(ErrorCode::board_line_unusable, "No line.");
      }
      ++made;
      return std::make_unique<sim::PretendBoard>(pretence);
    };
  }
  LastingChannel::Settings settings(bool may_lead_elsewhere) {
    return {.name = "a way",
            .pause = 1ms,
            .may_lead_elsewhere = may_lead_elsewhere,
            .listener = [this](const Result<std::string>& way) {
              const std::scoped_lock lock(mutex);
              told.push_back(way ? *way : way.error().message);
            }};
  }
  [[nodiscard]] std::vector<std::string> heard() {
    const std::scoped_lock lock(mutex);
    return told;
  }
};

}  // namespace

TEST_CASE("A way that cannot be opened yet is opened later, and each news is told once",
          "[hal][LNK-1][threads]") {
  Attempts attempts;
  attempts.failures = 4;
  LastingChannel channel(attempts.maker(), attempts.settings(false));
  const auto first = channel.open();
  REQUIRE_FALSE(first);
  CHECK(first.error().code == ErrorCode::board_line_unusable);
  CHECK_FALSE(channel.is_open());
  REQUIRE(becomes([&] { return channel.is_open(); }));
  CHECK(attempts.heard() == std::vector<std::string>{"No line.", "the other end"});
  channel.close();
  CHECK_FALSE(channel.is_open());
}

TEST_CASE("A way is opened anew when nobody answers there, if it may lead elsewhere",
          "[hal][LNK-1][threads]") {
  const bool may = GENERATE(false, true);
  Attempts attempts;
  LastingChannel channel(attempts.maker(), attempts.settings(may));
  REQUIRE(channel.open());
  channel.look_elsewhere();
  CHECK(channel.is_open() == !may);
  REQUIRE(becomes([&] { return channel.is_open(); }));
  CHECK(attempts.made == (may ? 2 : 1));
  CHECK(attempts.heard().size() == 1);
}

TEST_CASE("A serial line that is gone is opened by another thread; the link's allocates nothing",
          "[hal][LNK-1][LNK-4][threads]") {
  auto line = std::make_unique<Line>(line_name());
  auto channel = make_channel("serial:" + line_name().string());
  REQUIRE(channel);
  WirePort port(std::move(*channel), {});
  REQUIRE(port.begin({}));
  double now = 0.0;
  const auto exchange = [&] {
    now += 0.1;
    port.receive(now);
    port.exchange();
  };
  exchange();
  REQUIRE(line->hears_something());

  line.reset();
  REQUIRE(cnc::test::allocations_of_this_thread() > 0);
  const std::size_t before = cnc::test::allocations_of_this_thread();
  for (int i = 0; i < 200; ++i) exchange();
  const std::size_t after = cnc::test::allocations_of_this_thread();
  CHECK(after == before);

  line = std::make_unique<Line>(line_name());
  CHECK(becomes([&] {
    exchange();
    return line->hears_something();
  }));
}

TEST_CASE("Over UDP the board's datagrams are heard, a stranger's are not",
          "[hal][LNK-1][socket]") {
  boost::asio::io_context context;
  const auto loopback = boost::asio::ip::address_v4::loopback();
  udp::socket board(context, udp::endpoint(loopback, 0));
  udp::socket stranger(context, udp::endpoint(loopback, 0));
  UdpChannel channel("127.0.0.1", board.local_endpoint().port());
  REQUIRE(channel.open());
  const std::array<std::uint8_t, 3> question{1, 2, 3};
  channel.send(question);
  std::array<std::uint8_t, 16> memory;
  udp::endpoint host;
  REQUIRE(board.receive_from(boost::asio::buffer(memory), host) == question.size());
  stranger.send_to(boost::asio::buffer(std::array<std::uint8_t, 2>{9, 9}), host);
  board.send_to(boost::asio::buffer(std::array<std::uint8_t, 1>{7}), host);
  std::span<const std::uint8_t> answer;
  REQUIRE(becomes([&] {
    answer = channel.receive();
    return !answer.empty();
  }));
  CHECK(answer.size() == 1);
  CHECK(answer[0] == 7);
}

TEST_CASE("A socket that is open before its board uses it when it comes", "[hal][LNK-1][socket]") {
  boost::asio::io_context context;
  const auto loopback = boost::asio::ip::address_v4::loopback();
  auto board = std::make_unique<udp::socket>(context, udp::endpoint(loopback, 0));
  const std::uint16_t port = board->local_endpoint().port();
  board.reset();
  UdpChannel channel("127.0.0.1", port);
  REQUIRE(channel.open());
  const std::array<std::uint8_t, 3> question{1, 2, 3};
  for (int i = 0; i < 3; ++i) {  // each is answered by "nobody listens there"
    channel.send(question);
    CHECK(channel.receive().empty());
  }
  board = std::make_unique<udp::socket>(context, udp::endpoint(loopback, port));
  channel.send(question);
  std::array<std::uint8_t, 16> memory;
  udp::endpoint host;
  CHECK(board->receive_from(boost::asio::buffer(memory), host) == question.size());
}

TEST_CASE("The board is reached from the address and port of this computer that are set up",
          "[hal][LNK-1][socket]") {
  boost::asio::io_context context;
  const auto loopback = boost::asio::ip::address_v4::loopback();
  udp::socket board(context, udp::endpoint(loopback, 0));
  std::uint16_t free_port =
      udp::socket(context, udp::endpoint(loopback, 0)).local_endpoint().port();
  const auto channel =
      make_channel("udp:127.0.0.1:" + std::to_string(board.local_endpoint().port()),
                   "127.0.0.1:" + std::to_string(free_port));
  REQUIRE(channel);
  REQUIRE((*channel)->open());
  (*channel)->send(std::array<std::uint8_t, 1>{1});
  std::array<std::uint8_t, 16> memory;
  udp::endpoint host;
  REQUIRE(board.receive_from(boost::asio::buffer(memory), host) == 1);
  CHECK(host == udp::endpoint(loopback, free_port));

  // TEST-NET-1 (RFC 5737): nobody's, so not this computer's either.
  const auto elsewhere = make_channel("udp:127.0.0.1", "192.0.2.1");
  REQUIRE(elsewhere);
  const auto opened = (*elsewhere)->open();
  REQUIRE_FALSE(opened);
  CHECK(opened.error().code == ErrorCode::board_line_unusable);
  CHECK_THAT(opened.error().message, Contains("192.0.2.1") && Contains("localAddress"));
}

TEST_CASE("An address of this computer that is none says what one looks like", "[hal][LNK-1]") {
  for (const char* wrong :
       {"", "eth0", "172.22.2", "172.22.2.101:", "172.22.2.101:0", "::1", "172.22.2.101:70000"}) {
    CAPTURE(wrong);
    const auto channel = make_channel("auto", wrong);
    REQUIRE_FALSE(channel);
    CHECK(channel.error().code == ErrorCode::board_address_wrong);
  }
}
