#include "granular/run/frames.h"

#include <fmt/format.h>

#include "granular/io/output_file.h"
#include "granular/run/bed_of_world.h"
#include "granular/run/scene_world.h"

namespace granular {
namespace {

/// One number per particle.
template <class T, class Value>
VtkArray makeArray(const char* name, std::size_t count, Value value) {
  std::vector<T> column;
  column.reserve(count);
  for (std::size_t i = 0; i < count; ++i) column.push_back(static_cast<T>(value(i)));
  return {name, std::move(column), 1};
}

}  // namespace

FrameWriter::FrameWriter(const std::filesystem::path& out, const Scene& settings,
                         std::vector<FrameSeries::Entry> before)
    : folder(out / "frames"), scene(settings), particles(folder / "particles.pvd"), contacts(folder / "contacts.pvd") {
  prepareOutputFolder(folder);
  std::vector<FrameSeries::Entry> networks = before;
  for (FrameSeries::Entry& entry : networks) entry.file.replace(0, std::string("particles").size(), "contacts");
  particles.restore(std::move(before));
  contacts.restore(std::move(networks));
}

void FrameWriter::write(const World& world, std::int64_t number) {
  const Bodies& bodies = world.bodies;
  const std::size_t n = bodies.size();
  const Bed bed = makeBed(world, makeVessel(scene));
  std::vector<std::int32_t> touching(n, 0);
  for (const BedContact& contact : bed.contacts) {
    ++touching[static_cast<std::size_t>(contact.a)];
    if (contact.b >= 0) ++touching[static_cast<std::size_t>(contact.b)];
  }
  const std::vector<VtkArray> arrays{
      makeArray<std::int64_t>("id", n, [&](std::size_t i) { return bodies.id[i]; }),
      makeArray<std::int32_t>("shape", n, [&](std::size_t i) { return bodies.shapeIndex[i]; }),
      makeArray<std::int32_t>("material", n, [&](std::size_t i) { return bodies.material[i]; }),
      makeArray<std::int32_t>("coordination", n, [&](std::size_t i) { return touching[i]; }),
      makeArray<float>("speed", n, [&](std::size_t i) { return bodies.v(i).norm(); }),
      makeArray<float>("spin", n, [&](std::size_t i) { return bodies.w(i).norm(); }),
  };
  const std::string name = fmt::format("particles_{:05d}.vtp", number);
  writePolyData(folder / name, makeSurfaces(bed.shapes, bed.frames, arrays, static_cast<int>(scene.output.resolution)));
  particles.add(world.time, folder / name);
  if (!scene.output.contacts) return;
  const std::string network = fmt::format("contacts_{:05d}.vtp", number);
  writePolyData(folder / network, makeForceNetwork(bed));
  contacts.add(world.time, folder / network);
}

}  // namespace granular
