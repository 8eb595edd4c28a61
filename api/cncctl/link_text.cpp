// The health of the link to the board, for people: a table, and a histogram of each time.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

#include "api/cncctl/text.h"

namespace cnc::ctl {
namespace {

constexpr double kNeverMoved = 1e9;  // LinkStatistics::lowest_fifo_time
constexpr double kBarCells = 40.0;   // of a bin that has everything

std::string time_text(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.0f} us", 1e6 * seconds);
  if (seconds < 1.0) return fmt::format("{:.3g} ms", 1e3 * seconds);
  return fmt::format("{:.3g} s", seconds);
}

/// In eighths of a cell; what is there at all shows.
std::string bar(double part) {
  static constexpr const char* kEighths[]{"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const auto eighths = static_cast<std::size_t>(std::max(1L, std::lround(8.0 * kBarCells * part)));
  std::string text;
  for (std::size_t cell = 0; cell < eighths / 8; ++cell) text += "█";
  return text + kEighths[eighths % 8];
}

/// From the first bin that has something to the last one.
std::string histogram(std::string_view title, const std::vector<api::HistogramBin>& bins) {
  const auto is_filled = [](const api::HistogramBin& bin) { return bin.count > 0; };
  const auto first = std::ranges::find_if(bins, is_filled);
  const auto end = std::find_if(bins.rbegin(), bins.rend(), is_filled).base();
  if (first == bins.end()) return {};
  const auto all = static_cast<double>(std::accumulate(
      first, end, std::uint64_t{0},
      [](std::uint64_t sum, const api::HistogramBin& bin) { return sum + bin.count; }));
  std::string text = fmt::format("\n{}\n", title);
  for (auto bin = first; bin != end; ++bin) {
    const std::string upper = std::isinf(bin->upper) ? "more" : "< " + time_text(bin->upper);
    const double part = static_cast<double>(bin->count) / all;
    text += fmt::format("{:>12}{:>12}{:>8.2f} %  {}", upper, bin->count, 100.0 * part,
                        bin->count == 0 ? std::string() : bar(part));
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

std::string board_text(const api::LinkStatistics& statistics) {
  if (statistics.sessions == 0) return "has not answered yet";
  return fmt::format("{}, serial number {}, {}", statistics.board_name, statistics.board_serial,
                     statistics.connected ? "connected" : "LOST");
}

std::string_view name_of(api::LatchSource source) {
  switch (source) {
    case api::LatchSource::home:
      return "home switch";
    case api::LatchSource::probe:
      return "probe";
    case api::LatchSource::spindle_index:
      return "spindle index";
    case api::LatchSource::estop:
      return "emergency stop";
    case api::LatchSource::unknown:
      break;
  }
  return "other";
}

std::string latch_text(const api::LatchCatch& latch, const std::vector<api::Axis>& axes) {
  const auto of_axes = latch.axis ? std::vector{*latch.axis} : axes;
  std::string text = fmt::format("{} at {}, {} ago", name_of(latch.source),
                                 format_position(latch.position, of_axes), time_text(latch.age));
  if (latch.count > 0) text += fmt::format(", the {}. since power-up", latch.count);
  return text;
}

std::string line(std::string_view title, std::string_view text) {
  return fmt::format("{:<13}{}\n", title, text);
}

}  // namespace

std::string format_link(const api::LinkStatistics& statistics, const std::vector<api::Axis>& axes) {
  const api::PacketCounts& packets = statistics.packets;
  std::string text = line("board", board_text(statistics));
  text += line("sessions", fmt::format("{}", statistics.sessions));
  text += line("real time", statistics.real_time ? "yes" : "no");
  text += line("cycles",
               fmt::format("{} of {:.3f} ms", statistics.cycles, 1e3 * statistics.cycle_time));
  text += line("lateness", fmt::format("{} at most", time_text(statistics.max_lateness)));
  text += line("work", fmt::format("{} at most", time_text(statistics.max_work)));
  text += line("FIFO", statistics.lowest_fifo_time >= kNeverMoved
                           ? "has not moved"
                           : fmt::format("{} at least while moving with more to come",
                                         time_text(statistics.lowest_fifo_time)));
  text += line(
      "round trip",
      fmt::format("{} the last, {} the mean, {} at most", time_text(statistics.last_round_trip),
                  time_text(statistics.mean_round_trip), time_text(statistics.max_round_trip)));
  text += line("packets", fmt::format("{} sent, {} of them again", packets.sent, packets.resent));
  text += line("answers", fmt::format("{} taken, {} passed over, {} corrupted", packets.answered,
                                      packets.passed_over, packets.corrupted));
  for (const api::LatchCatch& latch : statistics.latches)
    text += line("latch", latch_text(latch, axes));
  text += histogram("lateness of cycles", statistics.lateness);
  text += histogram("work of cycles", statistics.work);
  text += histogram("FIFO while moving", statistics.fifo_time);
  text += histogram("round trips", statistics.round_trip);
  return text;
}

}  // namespace cnc::ctl
