#include "hal/cpu5/driver/lasting_channel.h"

#include <condition_variable>
#include <mutex>
#include <utility>

namespace cnc::hal::cpu5 {
namespace {

/// How soon the opener sees that a way is gone.
constexpr std::chrono::milliseconds kLook{100};

}  // namespace

LastingChannel::LastingChannel(Maker make, Settings settings)
    : make_(std::move(make)), settings_(std::move(settings)) {}

LastingChannel::~LastingChannel() { LastingChannel::close(); }

Result<void> LastingChannel::open() {
  close();
  auto opened = open_way();
  opener_ = std::jthread([this](const std::stop_token& stop) { keep_open(stop); });
  return opened;
}

void LastingChannel::close() {
  opener_ = {};  // ends
  way_.reset();
  holder_.store(Holder::opener, std::memory_order_relaxed);
}

// --- opener --------------------------------------------------------------------------------------

Result<void> LastingChannel::open_way() {
  way_.reset();  // a device has to be free before it can be opened
  auto made = make_();
  if (!made) {
    tell(std::unexpected(made.error()));
    return std::unexpected(made.error());
  }
  tell((*made)->name());
  way_ = std::move(*made);
  holder_.store(Holder::user, std::memory_order_release);
  return {};
}

void LastingChannel::keep_open(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  const auto sleep = [&](std::chrono::milliseconds time) {
    never.wait_for(lock, stop, time, [] { return false; });
  };
  for (sleep(kLook); !stop.stop_requested(); sleep(kLook)) {
    if (holder_.load(std::memory_order_acquire) == Holder::user) continue;
    if (!open_way()) sleep(settings_.pause);
  }
}

void LastingChannel::tell(const Result<std::string>& news) {
  std::string text = news ? *news : news.error().message;
  if (text == std::exchange(told_, text)) return;
  settings_.listener(news);
}

// --- user: real-time -----------------------------------------------------------------------------

bool LastingChannel::is_open() const {
  return holder_.load(std::memory_order_acquire) == Holder::user;
}

void LastingChannel::send(std::span<const std::uint8_t> packet) {
  if (!is_open()) return;
  way_->send(packet);
  give_back_if_gone();
}

std::span<const std::uint8_t> LastingChannel::receive() {
  if (!is_open()) return {};
  const auto packet = way_->receive();
  if (packet.empty()) give_back_if_gone();
  return packet;
}

void LastingChannel::look_elsewhere() {
  if (settings_.may_lead_elsewhere && is_open())
    holder_.store(Holder::opener, std::memory_order_release);
}

void LastingChannel::give_back_if_gone() {
  if (!way_->is_open()) holder_.store(Holder::opener, std::memory_order_release);
}

}  // namespace cnc::hal::cpu5
