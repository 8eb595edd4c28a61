#include "tests/process.h"

#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <poll.h>
#include <signal.h>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include "tests/patience.h"

// The header of glibc 2.36 does not say that its functions are C.
extern "C" {
#include <sys/pidfd.h>
}

namespace cnc::test {
namespace {

struct Streams {
  std::string in;
  std::string out;
  std::string err;
};

/// In the child, between fork and exec: nothing here may allocate.
[[noreturn]] void become(char* const* arguments, const Streams& streams) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  constexpr int kPrint = O_WRONLY | O_CREAT | O_TRUNC;
  dup2(open(streams.in.c_str(), O_RDWR | O_NOCTTY), STDIN_FILENO);
  dup2(open(streams.out.c_str(), kPrint, 0600), STDOUT_FILENO);
  dup2(open(streams.err.c_str(), kPrint, 0600), STDERR_FILENO);
  execv(arguments[0], arguments);
  _exit(127);
}

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Waits until the process has ended; a negative `timeout_ms` means without limit.
std::optional<int> reap(pid_t& id, int timeout_ms) {
  const int handle = pidfd_open(id, 0);
  if (handle < 0) throw std::runtime_error("the process has been waited for already");
  pollfd ended{.fd = handle, .events = POLLIN, .revents = 0};
  const int ready = poll(&ended, 1, timeout_ms);
  close(handle);
  if (ready != 1) return std::nullopt;
  int status = 0;
  waitpid(std::exchange(id, -1), &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments, std::string output,
                 const std::string& input)
    : output_(std::move(output)) {
  std::vector<std::string> copy = arguments;
  std::vector<char*> argv;
  for (std::string& argument : copy) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const Streams streams{.in = input, .out = output_ + ".out", .err = output_ + ".err"};
  id_ = fork();
  if (id_ == 0) become(argv.data(), streams);
  if (id_ < 0) throw std::runtime_error("cannot start " + arguments[0]);
}

Process::~Process() {
  if (id_ <= 0) return;
  kill(id_, SIGKILL);
  waitpid(id_, nullptr, 0);
}

void Process::signal(int number) const {
  if (id_ > 0) kill(id_, number);
}

std::string Process::out() const { return text_of(output_ + ".out"); }

std::string Process::err() const { return text_of(output_ + ".err"); }

bool Process::says(const std::string& text) const {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (err().find(text) == std::string::npos) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

std::optional<int> Process::exit_code(std::chrono::milliseconds patience) {
  return reap(id_, static_cast<int>(patience.count()));
}

Outcome Process::wait() {
  constexpr int kWithoutLimit = -1;
  const int code = reap(id_, kWithoutLimit).value();
  return {.exit_code = code, .out = out(), .err = err()};
}

}  // namespace cnc::test
