#include "granular/core/instruction_set.h"

namespace granular {

std::string_view instructionSet() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__AVX2__)
  return "AVX2";
#else
  return "x86-64";
#endif
}

}  // namespace granular
