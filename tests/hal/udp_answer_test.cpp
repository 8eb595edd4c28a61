// What a bare board answers on an Ethernet.
#include "hal/cpu5/target/udp_answer.h"

#include <catch2/catch.hpp>
#include <random>
#include <vector>

using namespace cnc::hal::cpu5::target;

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr NetworkName kBoard{
    .mac = {2, 0, 0x43, 0x35, 0, 1}, .ip = {172, 22, 2, 100}, .port = 5005};

/// The frame that a host, 172.22.2.101 at 52:55:0a:00:02:02, sends to ask for the board's address.
Bytes arp_question() {
  return {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x52, 0x55, 0x0A, 0,
          2,    2,    0x08, 0x06,                                      // to all, ARP
          0,    1,    8,    0,    6,    4,    0,    1,                 // who has
          0x52, 0x55, 0x0A, 0,    2,    2,    172,  22,   2,    101,   // I
          0,    0,    0,    0,    0,    0,    172,  22,   2,    100};  // the board?
}

/// "abc" from port 40000 to the board's port 5005 (0x138D).
Bytes datagram() {
  return {
      2,    0,    0x43, 0x35, 0,    1,    0x52, 0x55, 0x0A, 0,   2,  2,
      0x08, 0x00,                                                        // to the board, IP
      0x45, 0,    0,    31,   0x12, 0x34, 0,    0,    64,   17,  0,  0,  // 20 + 8 + 3 bytes, UDP
      172,  22,   2,    101,  172,  22,   2,    100,                     //
      0x9C, 0x40, 0x13, 0x8D, 0,    11,   0,    0,    'a',  'b', 'c'};
}

/// The board answers each payload by the same twice.
Bytes answer_to(const Bytes& frame) {
  std::array<std::uint8_t, kMaxEthernetFrame> out{};
  const auto twice = [](std::span<const std::uint8_t> payload, std::span<std::uint8_t> memory) {
    std::size_t size = 0;
    for (int i = 0; i < 2; ++i) {
      for (const std::uint8_t byte : payload) memory[size++] = byte;
    }
    return std::span<const std::uint8_t>(memory.first(size));
  };
  const auto answer = UdpAnswer(kBoard).answer(frame, out, twice);
  return {answer.begin(), answer.end()};
}

}  // namespace

TEST_CASE("Who asks for the board's address is told", "[hal][target][LNK-1]") {
  CHECK(answer_to(arp_question()) ==
        Bytes{0x52, 0x55, 0x0A, 0,    2, 2, 2,   0,  0x43, 0x35, 0, 1, 0x08, 0x06,  //
              0,    1,    8,    0,    6, 4, 0,   2,                                 // is at
              2,    0,    0x43, 0x35, 0, 1, 172, 22, 2,    100,                     // I
              0x52, 0x55, 0x0A, 0,    2, 2, 172, 22, 2,    101});                   // the host
  Bytes for_another = arp_question();
  for_another.back() = 99;
  CHECK(answer_to(for_another).empty());
}

TEST_CASE("A datagram's answer goes back to its sender, with the checksum of RFC 1071",
          "[hal][target][LNK-1]") {
  // Words of the header: 4500 0022 0000 0000 4011 0000 AC16 0264 AC16 0265; sum with carries
  // 0x4500 + 0x22 + 0x4011 + 2 * 0xAC16 + 0x264 + 0x265 = 0x1E228 -> 0xE229; inverted 0x1DD6.
  CHECK(answer_to(datagram()) ==
        Bytes{0x52, 0x55, 0x0A, 0,    2,   2,  2, 0,   0x43, 0x35, 0,    1,    0x08, 0x00,  //
              0x45, 0,    0,    34,   0,   0,  0, 0,   64,   17,   0x1D, 0xD6,              //
              172,  22,   2,    100,  172, 22, 2, 101,                                      //
              0x13, 0x8D, 0x9C, 0x40, 0,   14, 0, 0,   'a',  'b',  'c',  'a',  'b',  'c'});
}

TEST_CASE("What is not for the board, or not whole, is passed over", "[hal][target][safety]") {
  struct Row {
    const char* what;
    std::size_t place;
    std::uint8_t value;
  };
  const Row row = GENERATE(values<Row>({{"another protocol on Ethernet", 12, 0x86},
                                        {"IPv6", 14, 0x65},
                                        {"options", 14, 0x46},
                                        {"more fragments follow", 20, 0x20},
                                        {"a fragment", 21, 0x01},
                                        {"TCP", 23, 6},
                                        {"another address", 33, 99},
                                        {"another port", 37, 0x8E},
                                        {"a UDP length shorter than its header", 39, 7},
                                        {"a UDP length beyond the frame", 39, 12},
                                        {"an IP length that UDP does not fit in", 17, 30}}));
  INFO(row.what);
  Bytes frame = datagram();
  frame[row.place] = row.value;
  CHECK(answer_to(frame).empty());
}

TEST_CASE("Frames cut off anywhere are passed over, padding behind them is ignored",
          "[hal][target][safety]") {
  for (const Bytes& whole : {datagram(), arp_question()}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      REQUIRE(answer_to(Bytes(whole.begin(), whole.begin() + static_cast<long>(size))).empty());
    }
    Bytes padded = whole;
    padded.resize(60);
    CHECK(answer_to(padded) == answer_to(whole));
  }
}

TEST_CASE("A board that has no answer sends nothing", "[hal][target]") {
  std::array<std::uint8_t, kMaxEthernetFrame> out{};
  const auto silent = [](auto, auto) { return std::span<const std::uint8_t>{}; };
  CHECK(UdpAnswer(kBoard).answer(datagram(), out, silent).empty());
}
