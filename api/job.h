// The loaded program: what loading answers, its text, and what its check found.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "api/error.h"

namespace cnc::api {

struct LoadedJob {
  std::string path;  ///< absolute, on the server's computer
  std::uint64_t lines = 0;
  std::uint64_t bytes = 0;
};

struct ProgramText {
  std::uint64_t first = 1;         ///< number of lines.front()
  std::vector<std::string> lines;  ///< UTF-8 without line ends; fewer than asked at the end
};

/// A call of a sub.
struct CallSite {
  std::string sub;
  TextPlace place;  ///< where it was called

  friend bool operator==(const CallSite&, const CallSite&) = default;
};

struct Problem {
  Error error;  ///< always with a place
  std::string line_text;
  std::uint32_t length = 0;  ///< of the offending text from error.place->column, characters
  bool warning = false;
  std::vector<CallSite> calls{};  ///< that led to the line, innermost first; the last is the job's
};

struct ProblemList {
  std::vector<Problem> problems;
  bool complete = false;  ///< the whole file has been checked
};

}  // namespace cnc::api
