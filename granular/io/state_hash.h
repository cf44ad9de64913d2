// One line that two runs share if their bodies are the same to the bit.
#pragma once

#include <string>

#include "granular/body/bodies.h"

namespace granular {

/// SHA-256, in hexadecimal digits, of all bodies in the order of their ids: id, position (m), orientation (body to
/// world, x y z w), velocity (m/s) and spin (rad/s, world axes), as 64-bit numbers in the byte order of the machine.
/// The order of slots, and what is not a body's state, have no part in it.
std::string hashState(const Bodies& bodies);

}  // namespace granular
