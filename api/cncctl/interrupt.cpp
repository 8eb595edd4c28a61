#include "api/cncctl/interrupt.h"

#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <pthread.h>
#include <signal.h>

#include "api/cncctl/context.h"

namespace cnc::ctl {
namespace {

constexpr int kEndOfReceiver = SIGUSR1;

sigset_t received_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, kEndOfReceiver}) sigaddset(&set, signal);
  return set;
}

void receive(std::stop_source source) {
  const sigset_t set = received_signals();
  int signal = 0;
  while (sigwait(&set, &signal) == 0 && signal != kEndOfReceiver) {
    if (!source.request_stop()) std::_Exit(static_cast<int>(ExitCode::interrupted));
  }
}

}  // namespace

Interrupt::Interrupt() {
  const sigset_t set = received_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  receiver_ = std::thread(receive, source_);
}

Interrupt::~Interrupt() {
  pthread_kill(receiver_.native_handle(), kEndOfReceiver);
  receiver_.join();
}

void wait_for(const std::stop_token& interrupted) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any never;
  never.wait(lock, interrupted, [] { return false; });
}

bool wait_for(const std::stop_token& interrupted, std::chrono::milliseconds time) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any never;
  never.wait_for(lock, interrupted, time, [] { return false; });
  return interrupted.stop_requested();
}

}  // namespace cnc::ctl
