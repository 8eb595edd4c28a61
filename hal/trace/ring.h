// The last records of a trace, in memory that is allocated once: one thread writes and never waits,
// any thread may copy what is there at any time.
//
// The memory is a ring of words. A record is a word with its kind and its size in bytes, then its
// fields (fields.h), padded to whole words. Before the writer overwrites the oldest records it says
// where the oldest whole one will be; whoever copies looks at that afterwards and drops what may
// have been overwritten meanwhile. Each word is stored with release and loaded with acquire, so who
// sees an overwritten word sees the new place of the oldest record too.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "hal/trace/field_walkers.h"

namespace cnc::hal::trace {

/// A record's number among Request's alternatives, from 1; 0 is an Exchange.
using Kind = std::uint32_t;
inline constexpr Kind kExchange = 0;

template <typename T, typename... Ts>
consteval Kind index_in(const std::variant<Ts...>*) {
  Kind index = 0;
  static_cast<void>(((std::is_same_v<T, Ts> || (++index, false)) || ...));
  return index;
}
template <typename T>
inline constexpr Kind kKindOf = 1 + index_in<T>(static_cast<const Request*>(nullptr));
template <>
inline constexpr Kind kKindOf<Exchange> = kExchange;

struct RecordHead {
  Kind kind = 0;
  std::uint32_t bytes = 0;

  [[nodiscard]] std::size_t words() const { return 1 + (std::size_t{bytes} + 7) / 8; }
  [[nodiscard]] std::uint64_t word() const { return std::uint64_t{kind} << 32U | bytes; }
  [[nodiscard]] static RecordHead from(std::uint64_t word) {
    return {static_cast<Kind>(word >> 32U), static_cast<std::uint32_t>(word)};
  }
};

class Ring {
 public:
  /// 20 MiB: 30 s of 500 exchanges (712 bytes each) and 1750 segments (160 bytes each) a second.
  static constexpr std::size_t kUsualWords = std::size_t{5} << 19U;

  /// Allocates; `words` is at least 1024.
  explicit Ring(std::size_t words = kUsualWords);

  /// The writer. Real-time.
  template <typename T>
  void write(const T& record) {
    Buffer buffer;
    Encoder encoder(std::as_writable_bytes(std::span(buffer)).subspan(sizeof(std::uint64_t)));
    visit_fields(encoder, record);
    const RecordHead head{kKindOf<T>, static_cast<std::uint32_t>(encoder.size())};
    if (encoder.overflow()) return;
    buffer[0] = head.word();
    append(std::span(buffer).first(head.words()));
  }

  /// Any thread: what the next exchanges are recorded with.
  void note(std::uint32_t machine_state, std::uint64_t line) {
    machine_state_.store(machine_state, std::memory_order_relaxed);
    line_.store(line, std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint32_t machine_state() const {
    return machine_state_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t line() const { return line_.load(std::memory_order_relaxed); }

  /// Any thread: whole records, the oldest first. Allocates.
  [[nodiscard]] std::vector<std::uint64_t> copy() const;

  /// Room for the largest record, an exchange.
  static constexpr std::size_t kMostWords = 128;

 private:
  using Buffer = std::array<std::uint64_t, kMostWords>;

  void append(std::span<const std::uint64_t> record);
  /// A division for each word would take longer than all the rest.
  [[nodiscard]] std::uint64_t index_after(std::uint64_t index) const {
    return index + 1 == size_ ? 0 : index + 1;
  }

  std::uint64_t size_;
  std::unique_ptr<std::atomic<std::uint64_t>[]> words_;
  // Words since the beginning; a place in the ring is one of them modulo its size.
  std::atomic<std::uint64_t> oldest_{0};
  std::atomic<std::uint64_t> end_{0};
  std::atomic<std::uint32_t> machine_state_{0};
  std::atomic<std::uint64_t> line_{0};
};

}  // namespace cnc::hal::trace
