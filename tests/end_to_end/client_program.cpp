// A client that the tests kill:
//   e2e_client ADDRESS jog          jogs X at 20 % until it is stopped, lease 250 ms
//   e2e_client ADDRESS run FILE     loads and starts a job, then stays connected
#include <chrono>
#include <cstdio>
#include <string_view>
#include <thread>

#include "api/client.h"

namespace {

using namespace cnc::api;
using namespace std::chrono_literals;

template <typename T>
int report(const Result<T>& result) {
  if (result) return 0;
  std::fprintf(stderr, "%s\n", result.error().to_string().c_str());
  return 1;
}

int jog(const Client& client) {
  JogSession session = client.jog({.lease = 250ms});
  return report(session.while_held({{Axis::X, 0.2}}, [] { return true; }));
}

int run(const Client& client, const char* file) {
  if (const auto loaded = client.load(file); !loaded) return report(loaded);
  if (const auto started = client.run(); !started) return report(started);
  const auto watched = client.subscribe_status({}, [](const MachineStatus&) {});
  for (;;) std::this_thread::sleep_for(1h);
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) return 2;
  const auto client = Client::connect(arguments[1]);
  if (!client) return report(client);
  if (std::string_view(arguments[2]) == "jog") return jog(*client);
  return count < 4 ? 2 : run(*client, arguments[3]);
}
