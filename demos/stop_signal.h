// Ctrl-C and a polite kill ask a long run to write a checkpoint and end.
#pragma once

#include <csignal>

/// Becomes 1 when SIGINT or SIGTERM arrives after listenForStop().
inline volatile std::sig_atomic_t stopAsked = 0;

inline void listenForStop() {
  const auto ask = [](int) { stopAsked = 1; };
  std::signal(SIGINT, ask);
  std::signal(SIGTERM, ask);
  // A file larger than the shell allows is an error that is told, not the end of the process.
  std::signal(SIGXFSZ, SIG_IGN);
}
