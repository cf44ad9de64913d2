// Scene files: TOML read by the key table of scene_keys.h. Nothing is silently ignored: every unknown, missing, misused
// or impossible key is named with file, line, value and what is allowed, all of them in one error.
//
// Numbers are SI, or strings with a unit ("25 mm"), or expressions ("= 1.5 mm * aspect_ratio") of the scene's own
// [parameters]. Overrides "key.path=value" (array elements by number: particles.0.count=100) change the file's content
// before it is checked; a path of one word that names a parameter sets it, and nothing behind the sign
// takes the key out.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "granular/io/scene.h"

namespace granular {

/// Reads and checks a scene. Throws InputError listing every problem, one per line.
Scene readScene(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

/// The same from text; path stands for the file in messages, and its folder is where relative paths start.
Scene parseScene(std::string_view text, const std::filesystem::path& path,
                 const std::vector<std::string>& overrides = {});

/// Prints all keys with kind, unit, default, range and meaning.
void printSceneReference(std::ostream& out);

}  // namespace granular
