#include "hal/cpu5/driver/serial_channel.h"

#include <cerrno>
#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include "hal/cpu5/wire/messages.h"

namespace cnc::hal::cpu5 {

using boost::asio::serial_port;
using boost::asio::serial_port_base;
using boost::system::error_code;

// A byte takes 10 bits on the line.
static_assert(SerialChannel::kRates.front() >=
              500 * 10 * wire::cobs_size(wire::kHeaderSize + wire::kMaxStatus + wire::kCrcSize));

SerialChannel::SerialChannel(std::string device, unsigned rate)
    : device_(std::move(device)), rate_(rate), port_(context_) {}

Result<void> SerialChannel::open() {
  close();
  error_code wrong;
  // Asio opens with raw characters: no echo, no translation.
  port_.open(device_, wrong);
  if (!wrong) port_.set_option(serial_port_base::baud_rate(rate_), wrong);
  if (!wrong) port_.set_option(serial_port_base::character_size(8), wrong);
  if (!wrong) port_.set_option(serial_port_base::parity(serial_port_base::parity::none), wrong);
  if (!wrong)
    port_.set_option(serial_port_base::stop_bits(serial_port_base::stop_bits::one), wrong);
  if (!wrong) {
    port_.set_option(serial_port_base::flow_control(serial_port_base::flow_control::none), wrong);
  }
  if (wrong) {
    close();
    return fail(ErrorCode::board_line_unusable,
                fmt::format("{} cannot be used: {}. It has to be a serial line that this user may "
                            "read and write (group dialout).",
                            name(), wrong.message()));
  }
  const int flags = ::fcntl(port_.native_handle(), F_GETFL);
  ::fcntl(port_.native_handle(), F_SETFL, flags | O_NONBLOCK);
  reader_ = {};
  read_place_ = read_size_ = write_place_ = write_size_ = 0;
  return {};
}

void SerialChannel::close() {
  error_code ignored;
  port_.close(ignored);
  is_gone_ = false;
}

/// While the line has not taken the whole packet before, this one is lost.
void SerialChannel::send(std::span<const std::uint8_t> packet) {
  write_rest();
  if (write_place_ < write_size_) return;
  write_size_ = wire::write_cobs(packet, written_);
  write_place_ = 0;
  write_rest();
}

void SerialChannel::write_rest() {
  while (is_open() && write_place_ < write_size_) {
    const auto taken =
        ::write(port_.native_handle(), written_.data() + write_place_, write_size_ - write_place_);
    if (taken <= 0) return note_if_gone(taken);
    write_place_ += static_cast<std::size_t>(taken);
  }
}

/// `result` of a read or write, not more than 0.
void SerialChannel::note_if_gone(::ssize_t result) {
  if (result < 0 && errno != EAGAIN && errno != EINTR) is_gone_ = true;
}

std::span<const std::uint8_t> SerialChannel::receive() {
  write_rest();
  while (is_open()) {
    while (read_place_ < read_size_) {
      if (reader_.take(read_[read_place_++])) return reader_.packet();
    }
    const auto size = ::read(port_.native_handle(), read_.data(), read_.size());
    if (size <= 0) {
      note_if_gone(size);
      return {};
    }
    read_place_ = 0;
    read_size_ = static_cast<std::size_t>(size);
  }
  return {};
}

}  // namespace cnc::hal::cpu5
