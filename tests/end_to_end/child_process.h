// A child process that cannot outlive its test: it is killed with the object, and by the kernel
// when the test itself is killed.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace cnc::test {

class ChildProcess {
 public:
  /// `arguments[0]` is the program; what it prints (both streams) goes to the file `output`.
  ChildProcess(const std::vector<std::string>& arguments, std::string output);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();

  void signal(int number) const;
  /// Its exit code, 128 + signal if a signal ended it; nothing while it still runs after `timeout`.
  std::optional<int> exit_code(std::chrono::milliseconds timeout);
  /// What it has printed so far.
  [[nodiscard]] std::string output() const;

 private:
  pid_t id_ = -1;
  std::string output_;
};

}  // namespace cnc::test
