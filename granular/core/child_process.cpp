#include "granular/core/child_process.h"

#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "granular/core/sanitizer.h"

namespace granular {
namespace {

void limitChild(std::int64_t memoryBytes, double seconds) {
  const auto limit = [](auto resource, std::int64_t soft) {
    const rlimit value{static_cast<rlim_t>(soft), static_cast<rlim_t>(soft)};
    ::setrlimit(resource, &value);
  };
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<std::int64_t>(seconds) + 1);
  if (anySanitizer) return;
  // The child begins with the parent's address space; the budget comes on top.
  std::ifstream statm("/proc/self/statm");
  std::int64_t pages = 0;
  statm >> pages;
  limit(RLIMIT_AS, pages * ::sysconf(_SC_PAGESIZE) + memoryBytes);
}

}  // namespace

ChildProcess::ChildProcess(std::string worker, const Limits& limits, const std::function<void(int pipe)>& work)
    : name(std::move(worker)), clockLimit(2 * limits.seconds) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe to " + name + ": " + std::strerror(errno));
  std::fflush(nullptr);
  process = ::fork();
  if (process == 0) {
    ::close(ends[0]);
    // What a crashing library prints is of no use to anyone.
    if (std::freopen("/dev/null", "w", stderr) == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr)
      ::_exit(3);
    for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) ::signal(signal, SIG_DFL);
    limitChild(limits.memoryBytes, limits.seconds);
    work(ends[1]);
    ::_exit(0);
  }
  ::close(ends[1]);
  pipe = ends[0];
  if (process < 0) {
    ::close(pipe);
    throw std::runtime_error("no process for " + name + ": " + std::strerror(errno));
  }
  start = std::chrono::steady_clock::now();
}

bool ChildProcess::read(void* data, std::size_t bytes) {
  char* at = static_cast<char*>(data);
  while (bytes > 0) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    const int left = static_cast<int>(1000 * (clockLimit - passed.count()));
    pollfd waiting{pipe, POLLIN, 0};
    const int ready = left > 0 ? ::poll(&waiting, 1, left) : 0;
    if (ready < 0 && errno == EINTR) continue;
    timedOut = ready == 0;
    if (ready <= 0) return false;
    const ssize_t got = ::read(pipe, at, bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

std::string ChildProcess::finish() {
  if (process <= 0) return "";
  ::close(pipe);
  if (timedOut) ::kill(process, SIGKILL);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  process = 0;
  if (timedOut || (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))) {
    return name + " took more than its time and was stopped; the file is malformed or too big";
  }
  if (WIFSIGNALED(status))
    return name + " crashed on it (signal " + std::to_string(WTERMSIG(status)) + "); the file is malformed";
  return name + " gave no answer; the file is malformed";
}

void writeToParent(int pipe, const void* data, std::size_t bytes) {
  const char* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t written = ::write(pipe, at, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) ::_exit(3);
    at += written;
    bytes -= static_cast<std::size_t>(written);
  }
}

}  // namespace granular
