#include "tests/api/terminal.h"

#include <fcntl.h>
#include <stdexcept>
#include <stdlib.h>
#include <unistd.h>

namespace cnc::test {

Terminal::Terminal() : keyboard_(posix_openpt(O_RDWR | O_NOCTTY)) {
  const bool good = keyboard_ >= 0 && grantpt(keyboard_) == 0 && unlockpt(keyboard_) == 0;
  if (!good) throw std::runtime_error("no pseudo-terminal");
  path_ = ptsname(keyboard_);
}

Terminal::~Terminal() { close(keyboard_); }

void Terminal::type(std::string_view keys) const {
  if (write(keyboard_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size()))
    throw std::runtime_error("cannot type");
}

}  // namespace cnc::test
