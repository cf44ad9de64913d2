// Whether a loaded world can be gone on with: no index leads nowhere, and no list is shorter than its neighbours. A
// checkpoint's digest guards against damage; this, against a file that a mistake or another program wrote.
#pragma once

#include "granular/world/world.h"

namespace granular {

/// Throws InputError naming what is wrong. Only what the lists say of each other is checked, not the numbers in them.
void checkLoaded(World& world);

}  // namespace granular
