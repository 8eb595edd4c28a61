// A pendant in sixty lines: shows position and state, and moves X and Y while an arrow key is held.
//
//   pendant [ADDRESS]      arrow keys move, q ends
//
// A terminal tells a key's repetitions but not its release, so a key counts as held for as long as
// its repetitions come. If this program hangs or dies, nobody renews the jog's lease and the
// machine stops.
#include <cstdio>
#include <map>
#include <poll.h>
#include <string>
#include <termios.h>
#include <unistd.h>
#include <utility>

#include "api/client.h"

namespace {

using cnc::api::Axis;

constexpr int kRepetitionMs = 120;  // longer than between two repetitions, shorter than the lease

const std::map<std::string, cnc::api::JogVelocity> kKeys{{"\x1b[C", {Axis::X, 0.3}},
                                                         {"\x1b[D", {Axis::X, -0.3}},
                                                         {"\x1b[A", {Axis::Y, 0.3}},
                                                         {"\x1b[B", {Axis::Y, -0.3}}};

/// What was typed within the time; empty if nothing.
std::string read_key(int timeout_ms) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char bytes[8];
  if (poll(&input, 1, timeout_ms) <= 0) return {};
  const ssize_t size = read(STDIN_FILENO, bytes, sizeof bytes);
  return size > 0 ? std::string(bytes, static_cast<std::size_t>(size)) : "q";
}

void show(const cnc::api::MachineStatus& status) {
  const auto& at = status.work_position;
  std::printf("\rX%10.3f Y%10.3f Z%10.3f  %-40s", at[Axis::X], at[Axis::Y], at[Axis::Z],
              status.state_text.c_str());
  std::fflush(stdout);
}

int run(const cnc::api::Client& client) {
  const auto statuses = client.subscribe_status({.max_rate = 10}, show);
  std::string key;
  while (key != "q") {
    const auto jog = kKeys.find(key);
    if (jog == kKeys.end()) {
      key = read_key(-1);
      continue;
    }
    const auto moved = client.jog().while_held({jog->second}, [&, is_first = true]() mutable {
      if (!std::exchange(is_first, false)) key = read_key(kRepetitionMs);
      return key == jog->first;
    });
    if (!moved) std::printf("\n%s\n", moved.error().to_string().c_str());
    if (!moved) key.clear();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto client = cnc::api::Client::connect(argc > 1 ? argv[1] : cnc::api::default_address());
  if (!client) return std::fprintf(stderr, "%s\n", client.error().to_string().c_str()), 1;
  termios before{};
  tcgetattr(STDIN_FILENO, &before);
  termios raw = before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  const int code = run(*client);
  tcsetattr(STDIN_FILENO, TCSANOW, &before);
  return code;
}
