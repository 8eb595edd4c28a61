#include "tests/end_to_end/child_process.h"

#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <poll.h>
#include <signal.h>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

// The header of glibc 2.36 does not say that its functions are C.
extern "C" {
#include <sys/pidfd.h>
}

namespace cnc::test {
namespace {

/// In the child, between fork and exec: nothing here may allocate.
[[noreturn]] void become(char* const* arguments, const char* output) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);  // not the terminal of whoever runs the tests
  const int file = open(output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(file, STDOUT_FILENO);
  dup2(file, STDERR_FILENO);
  execv(arguments[0], arguments);
  _exit(127);
}

int exit_code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, std::string output)
    : output_(std::move(output)) {
  std::vector<std::string> copy = arguments;
  std::vector<char*> argv;
  for (std::string& argument : copy) argv.push_back(argument.data());
  argv.push_back(nullptr);
  id_ = fork();
  if (id_ == 0) become(argv.data(), output_.c_str());
  if (id_ < 0) throw std::runtime_error("cannot start " + arguments[0]);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : id_(std::exchange(other.id_, -1)), output_(std::move(other.output_)) {}

ChildProcess::~ChildProcess() {
  if (id_ <= 0) return;
  kill(id_, SIGKILL);
  waitpid(id_, nullptr, 0);
}

void ChildProcess::signal(int number) const {
  if (id_ > 0) kill(id_, number);
}

std::optional<int> ChildProcess::exit_code(std::chrono::milliseconds timeout) {
  const int handle = pidfd_open(id_, 0);
  if (handle < 0) throw std::runtime_error("the process has been waited for already");
  pollfd ended{.fd = handle, .events = POLLIN, .revents = 0};
  const int ready = poll(&ended, 1, static_cast<int>(timeout.count()));
  close(handle);
  if (ready != 1) return std::nullopt;
  int status = 0;
  waitpid(std::exchange(id_, -1), &status, 0);
  return exit_code_of(status);
}

std::string ChildProcess::output() const {
  std::ifstream file(output_, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace cnc::test
