// What the library was compiled for: which of its variants runs (extern/variants.cmake).
#pragma once

#include <string_view>

namespace granular {

/// "AVX-512", "AVX2", or "x86-64" for any.
std::string_view instructionSet();

}  // namespace granular
