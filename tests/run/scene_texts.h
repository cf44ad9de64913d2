// Scenes small enough to be run to rest in a test, and the folder they are run in.
#pragma once

#include <fmt/format.h>
#include <omp.h>

#include <csignal>
#include <fstream>
#include <string>
#include <vector>

#include "granular/run/packing_run.h"
#include "io/scratch_folder.h"

namespace granular {

/// Soft contacts, for long steps; nothing drawn; an early rest.
inline const std::string commonText = R"(
[model]
point_rule = "patch"
[contact_default]
stiffness = "500 N/m"
restitution = 0.5
[rest]
energy = 1e-3
time = "5 ms"
max_time = "2 s"
[output]
picture = false
plots = false
stl = false
glb = false
)";

inline const std::string narrowBox = R"(
[vessel]
kind = "box"
size = ["15 mm", "15 mm", "100 mm"]
)";

/// A few of each: round, flat, curved with edges, scanned.
inline const std::string mixture = std::string(R"(
[[particles]]
shape = "sphere"
radius = "1.5 mm"
share = 0.2
[[particles]]
shape = "cuboid"
half_lengths = ["1.2 mm", "1.2 mm", "1.5 mm"]
share = 0.2
[[particles]]
shape = "cylinder"
radius = "1.2 mm"
height = "2.6 mm"
share = 0.2
[[particles]]
shape = "ellipsoid"
semi_axes = ["1.2 mm", "1.2 mm", "2 mm"]
share = 0.2
[[particles]]
shape = "mesh"
files = [")") + GRANULAR_SOURCE_DIR R"(/meshes/pebble_mm.stl"]
unit = "mm"
extent = ["3 mm", "4 mm"]
max_vertices = 30
share = 0.2
)";

inline const std::string spheres = R"(
[[particles]]
shape = "sphere"
radius = "1.5 mm"
)";

/// Runs of scenes in a folder of their own.
class RunTest : public ScratchFolder {
 protected:
  const volatile std::sig_atomic_t never = 0, atOnce = 1;

  void SetUp() override {
    ScratchFolder::SetUp();
    omp_set_num_threads(1);  // so few particles gain nothing from more
  }

  SceneSource write(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    const auto file = folder / "scene.toml";
    std::ofstream(file) << text;
    return SceneSource::read(file, overrides);
  }

  /// A folder for results, made.
  std::filesystem::path makeFolder(const std::string& name) const {
    std::filesystem::create_directories(folder / name);
    return folder / name;
  }

  /// What building the scene complains about; empty if it does not.
  std::string complaintOf(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    try {
      PackingRun run(write(text, overrides));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

/// Every text must be part of the message.
inline void expectMentions(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << part << " is not in: " << message;
}

}  // namespace granular
