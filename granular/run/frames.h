// Frames of a run for ParaView: particle surfaces and the force network, each as a growing collection.
#pragma once

#include <filesystem>

#include "granular/io/scene.h"
#include "granular/io/vtk_writer.h"
#include "granular/world/world.h"

namespace granular {

class FrameWriter {
 public:
  /// Writes into out/frames; goes on with the entries of an interrupted run.
  FrameWriter(const std::filesystem::path& out, const Scene& scene, std::vector<FrameSeries::Entry> before);

  /// Writes the world as frame `number` and adds it to particles.pvd and contacts.pvd.
  void write(const World& world, std::int64_t number);

  const std::vector<FrameSeries::Entry>& entries() const { return particles.entries(); }

 private:
  std::filesystem::path folder;
  const Scene& scene;
  FrameSeries particles, contacts;
};

}  // namespace granular
