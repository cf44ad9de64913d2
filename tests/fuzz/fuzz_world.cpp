// What a checkpoint says of a world: a true one with entries, lengths and types spoilt gives a world that can be
// stepped, or an InputError. Edits are taken from the input one after the other: which data set, what to do, where,
// with what.
#include "fuzz/fuzz_input.h"
#include "granular/core/errors.h"
#include "granular/run/packing_run.h"
#include "granular/run/world_archive.h"

namespace granular {
namespace {

constexpr const char* sceneText = R"(
seed = 1
[vessel]
kind = "box"
size = ["15 mm", "15 mm", "100 mm"]
[model]
point_rule = "patch"
[contact_default]
stiffness = "500 N/m"
restitution = 0.5
[settle]
kind = "sleep"
energy = 0.01
[insertion]
kind = "poses"
file = "poses.txt"
[[particles]]
shape = "sphere"
radius = "1.5 mm"
[[particles]]
shape = "cuboid"
half_lengths = ["1.2 mm", "1.2 mm", "1.5 mm"]
[[particles]]
shape = "polyhedron"
vertices = [["2 mm", 0, 0], ["-2 mm", 0, 0], [0, "2 mm", 0], [0, "-2 mm", 0], [0, 0, "2 mm"], [0, 0, "-1 mm"]]
[[particles]]
shape = "cylinder"
radius = "1.2 mm"
height = "2.6 mm"
[[particles]]
shape = "clump"
radii = ["1 mm", "1.2 mm"]
centres = [[0, 0, 0], ["1.5 mm", 0, 0]]
)";

PackingRun makeBed() {
  static const SceneSource source = [] {
    std::string poses;
    for (int k = 0; k < 15; ++k) {
      poses += std::to_string(4.2e-3 * (k % 3 - 1)) + " " + std::to_string(4.2e-3 * (k / 3 % 3 - 1)) + " " +
               std::to_string(3e-3 + 4.2e-3 * (k / 9)) + " 1 0 0 0 " + std::to_string(k % 5) + "\n";
    }
    fuzz::writeFile(fuzz::scratch() / "poses.txt", poses);
    fuzz::writeFile(fuzz::scratch() / "scene.toml", sceneText);
    return SceneSource::read(fuzz::scratch() / "scene.toml", {});
  }();
  return PackingRun(source);
}

const std::map<std::string, DataSet>& trueContent() {
  static const std::map<std::string, DataSet> content = [] {
    PackingRun bed = makeBed();
    while (bed.world().time < 0.05) step(bed.world(), bed.timeStep());
    Archive archive;
    describe(archive, bed.world());
    return archive.content();
  }();
  return content;
}

void spoil(fuzz::Input& input, std::map<std::string, DataSet>& content) {
  auto at = content.begin();
  std::advance(at, input.take<std::uint8_t>() % content.size());
  DataSet& set = at->second;
  const std::size_t row = set.width * elementSize(set.type), size = elementSize(set.type);
  switch (input.take<std::uint8_t>() % 6) {
    case 0:
      content.erase(at);
      break;
    case 1:
      set.rows = input.take<std::uint8_t>();
      set.bytes.resize(set.rows * row);
      break;
    case 2:
      set.rows = input.take<std::uint64_t>();  // the bytes stay
      break;
    case 3:
      set.type = static_cast<ElementType>(input.take<std::uint8_t>() % 6);
      break;
    default: {
      const std::size_t entry = input.take<std::uint16_t>();
      const auto value = input.take<std::uint64_t>();
      if (set.bytes.size() < size) break;
      std::memcpy(set.bytes.data() + entry % (set.bytes.size() / size) * size, &value, size);
    }
  }
}

}  // namespace
}  // namespace granular

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace granular;
  fuzz::Input input(data, size);
  std::map<std::string, DataSet> content = trueContent();
  while (!input.empty() && !content.empty()) spoil(input, content);
  PackingRun bed = makeBed();
  try {
    Archive archive(std::move(content), "spoilt");
    describe(archive, bed.world());
    archive.requireAllRead();
  } catch (const InputError&) {
    return 0;
  }
  for (int k = 0; k < 3; ++k) step(bed.world(), bed.timeStep());
  wakeAll(bed.world());
  for (int k = 0; k < 3; ++k) step(bed.world(), bed.timeStep());
  return 0;
}
