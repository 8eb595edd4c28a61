#include "server/daemon/real_time.h"

#include <cerrno>
#include <cstring>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

namespace cnc::server {

std::string request_fifo(std::thread::native_handle_type thread, int priority) {
  const sched_param wanted{priority};
  const int refused = pthread_setschedparam(thread, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted);
  return refused == 0 ? std::string{} : std::strerror(refused);
}

std::string lock_memory() {
  return mlockall(MCL_CURRENT) == 0 ? std::string{} : std::strerror(errno);
}

}  // namespace cnc::server
