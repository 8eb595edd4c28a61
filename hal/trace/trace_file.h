// A trace as a file (docs/trace.md): what was recorded, of which machine, and why it was written.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hal/cpu5/driver/cpu5_driver.h"
#include "hal/trace/records.h"

namespace cnc::hal::trace {

/// What a reader has to know beside the records.
struct About {
  std::string reason{};   ///< "estop", "link_lost" …, or "asked for"
  std::string written{};  ///< UTC: "2026-05-01T12:30:05Z"
  std::string server{};   ///< version of the program that wrote it
  std::string board{};    ///< "virtual CPU5 board"
  cpu5::DriverSettings driver{};
  std::string config{};  ///< of the machine, as a cnc.ini
};

/// An exchange and the requests that went out with it.
struct Step {
  std::vector<Request> requests;
  Exchange exchange;
};

struct Trace {
  About about;
  std::vector<Step> steps;
};

/// The file's bytes: the last `seconds` of the records of Ring::copy().
[[nodiscard]] std::string trace_bytes(const About& about, std::span<const std::uint64_t> records,
                                      double seconds = 30.0);

/// Refused as a whole when anything is missing, damaged, or of another layout. `name` is the file's
/// name for errors.
[[nodiscard]] Result<Trace> parse_trace(std::string_view bytes, std::string_view name);
[[nodiscard]] Result<Trace> read_trace(const std::filesystem::path& path);

/// Name and type of every field of every record, in the order of its bytes.
[[nodiscard]] std::string layout();

}  // namespace cnc::hal::trace
