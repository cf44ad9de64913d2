// What the keys of a scene must satisfy together.
#pragma once

#include <functional>
#include <string>

#include "granular/io/scene.h"

namespace granular {

/// Reports each contradiction between keys: path is the key to blame ("contact.0.between"), message says what is wrong
/// and what is allowed.
void checkScene(const Scene& scene,
                const std::function<void(const std::string& path, const std::string& message)>& report);

}  // namespace granular
