// Work on foreign bytes in a process of its own, with bounds on memory and time: a library that crashes on a malformed
// file takes nobody with it. What the child writes to its pipe is read here.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace granular {

class ChildProcess {
 public:
  struct Limits {
    std::int64_t memoryBytes;  ///< on top of what this process has
    double seconds;            ///< of its processor; twice as long by the clock
  };
  /// Starts work(pipe) in a child. worker: what messages call it, "the loader". Nothing that the child prints is shown.
  /// Throws std::runtime_error where the system gives no process.
  ChildProcess(std::string worker, const Limits& limits, const std::function<void(int pipe)>& work);
  /// Waits for the child; one whose time is over is killed.
  ~ChildProcess() { finish(); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Reads exactly so many bytes; false when the child ended or its time is over.
  bool read(void* data, std::size_t bytes);
  /// Why the child ended without all that was asked of it, in words.
  std::string finish();

 private:
  std::string name;
  int process = 0;
  int pipe = -1;
  double clockLimit;
  bool timedOut = false;
  std::chrono::steady_clock::time_point start;
};

/// In the child: writes it all, or ends the child.
void writeToParent(int pipe, const void* data, std::size_t bytes);

}  // namespace granular
