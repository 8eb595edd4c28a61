// A program beside a test, and what it prints. It cannot outlive its test: it is killed with the
// object, and by the kernel when the test itself is killed.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace cnc::test {

struct Outcome {
  int exit_code = -1;  ///< 128 + signal if a signal ended it, 127 if it could not be started
  std::string out;
  std::string err;
};

class Process {
 public:
  /// `arguments[0]` is the program. What it prints goes to the files `output`.out and `output`.err;
  /// it reads from the file or terminal `input`.
  Process(const std::vector<std::string>& arguments, std::string output,
          const std::string& input = "/dev/null");
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  void signal(int number) const;
  /// What it has printed so far.
  [[nodiscard]] std::string out() const;
  [[nodiscard]] std::string err() const;
  /// Whether it has printed this on stderr within kPatience.
  [[nodiscard]] bool says(const std::string& text) const;

  /// As in Outcome; nothing while it still runs after `patience`.
  std::optional<int> exit_code(std::chrono::milliseconds patience);
  /// Waits for its end, as long as ctest lets the test run.
  Outcome wait();

 private:
  pid_t id_ = -1;  // -1 once its end has been seen
  std::string output_;
};

}  // namespace cnc::test
