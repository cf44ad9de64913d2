// The end of a demo's main(): what it threw is told, and becomes an exit code.
#pragma once

#include <cstdio>
#include <exception>

#include "granular/core/errors.h"

/// The exit codes that all demos share.
enum CommonExit { exitInput = 1, exitProgram = 2 };

/// Calls run(), which returns an exit code. Bad input becomes exitInput, any other exception exitProgram.
template <class Run>
int exitCodeOf(const char* demo, Run&& run) {
  try {
    return run();
  } catch (const granular::InputError& error) {
    std::fprintf(stderr, "%s: %s\n", demo, error.what());
    return exitInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", demo, error.what());
    return exitProgram;
  }
}
