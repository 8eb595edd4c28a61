// Runs a program and keeps what it prints.
#pragma once

#include <string>
#include <sys/types.h>
#include <vector>

namespace cnc::test {

struct Outcome {
  int exit_code = -1;  ///< 128 + signal if a signal ended it
  std::string out;
  std::string err;
};

/// A running program; its output goes to files in a temporary folder.
class Process {
 public:
  /// `arguments[0]` is the program; it reads from the file or terminal `input`.
  Process(const std::vector<std::string>& arguments, const std::string& folder,
          const std::string& input = "/dev/null");
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  void signal(int number) const;
  /// Whether it has printed this on stderr within kPatience.
  [[nodiscard]] bool says(const std::string& text) const;
  /// Waits for its end.
  [[nodiscard]] Outcome wait();

 private:
  pid_t id_ = -1;
  std::string folder_;
};

}  // namespace cnc::test
