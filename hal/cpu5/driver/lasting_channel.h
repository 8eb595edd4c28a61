// A way to the board that is opened by a thread of its own, and anew whenever it is gone: the link
// thread neither opens devices nor allocates, and a board that is off, unplugged or not found yet
// is waited for.
//
// The way inside belongs to one thread at a time, and one atomic says to which: to the opener until
// it has opened it, then to the user, who gives it back when the device is gone.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "hal/cpu5/driver/packet_channel.h"

namespace cnc::hal::cpu5 {

class LastingChannel final : public PacketChannel {
 public:
  /// Finds the way and opens it; may take its time.
  using Maker = std::function<Result<std::unique_ptr<PacketChannel>>()>;
  /// What has become of the way, when that is new: its name, or why it cannot be used. Is called
  /// by open() and by the opener.
  using Listener = std::function<void(const Result<std::string>&)>;

  struct Settings {
    std::string name;                      ///< of this channel
    std::chrono::milliseconds pause{500};  ///< between two attempts to open it
    /// Whether look_elsewhere() opens the way anew. Not where that would reset a board that is
    /// only slow to start, as opening a serial line does with some.
    bool may_lead_elsewhere = false;
    Listener listener = [](const Result<std::string>&) {};
  };

  LastingChannel(Maker make, Settings settings);
  ~LastingChannel() override;

  /// Tries once at once, and says how that went. When it failed, the opener goes on trying.
  Result<void> open() override;
  void close() override;
  [[nodiscard]] bool is_open() const override;
  void send(std::span<const std::uint8_t> packet) override;
  std::span<const std::uint8_t> receive() override;
  void look_elsewhere() override;
  [[nodiscard]] std::string name() const override { return settings_.name; }

 private:
  enum class Holder : std::uint8_t { opener, user };

  Result<void> open_way();
  void keep_open(const std::stop_token& stop);
  void tell(const Result<std::string>& news);
  void give_back_if_gone();

  Maker make_;
  Settings settings_;
  std::atomic<Holder> holder_{Holder::opener};
  std::unique_ptr<PacketChannel> way_;  // the holder's
  std::string told_;                    // open()'s, then the opener's
  std::jthread opener_;
};

}  // namespace cnc::hal::cpu5
