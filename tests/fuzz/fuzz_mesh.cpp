// The mesh importer: the first byte chooses the format, the rest is the file. Any file gives a rock or an InputError.
// The loader runs in its child process as it does for users; with GRANULAR_FUZZ_IN_PROCESS set it runs in this one,
// where faults of assimp itself show too.
#include "fuzz/fuzz_input.h"
#include "granular/core/errors.h"
#include "granular/mesh/repair.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool inChild = std::getenv("GRANULAR_FUZZ_IN_PROCESS") == nullptr;
  constexpr const char* names[] = {"a.obj", "a.stl", "a.ply", "a.off", "a.gltf", "a.glb"};
  granular::fuzz::Input input(data, size);
  const auto path = granular::fuzz::scratch() / names[input.take<std::uint8_t>() % std::size(names)];
  granular::fuzz::writeFile(path, input.rest());
  try {
    granular::ImportLimits limits;
    limits.inChild = inChild;
    limits.seconds = 2;
    granular::repairMesh(granular::importMesh(path.string(), limits));
  } catch (const granular::InputError&) {
  }
  return 0;
}
