// Errors a user can act on. Bad input throws InputError; a broken invariant is an assert; run-time trouble is counted.
#pragma once

#include <stdexcept>
#include <string>

namespace granular {

/// Bad input: the message names what was given, where, and what is allowed.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws InputError(message) unless condition holds.
inline void require(bool condition, const std::string& message) {
  if (!condition) throw InputError(message);
}

}  // namespace granular
