// A packing whose scene chooses a model by name.
#pragma once

#include <string>

#include "granular/run/packing_run.h"

namespace granular {

/// Ten balls in a small cylinder, with these lines under [model].
inline PackingRun runWithModel(const std::string& model) {
  const std::string text =
      "[vessel]\nkind = \"cylinder\"\nradius = 0.01\n[contact_default]\nstiffness = 1e3\nrestitution = 0.5\n"
      "[model]\n" +
      model + "\n[[particles]]\nshape = \"sphere\"\nradius = 0.001\ncount = 10\n";
  return PackingRun(SceneSource{"model.toml", text, {}});
}

}  // namespace granular
