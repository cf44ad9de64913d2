// Triangle meshes to files.
#pragma once

#include <string>

#include "granular/shape/shape.h"

namespace granular {

/// Writes a mesh as binary STL, OBJ, PLY or OFF (text), after the extension of the path; coordinates are divided by
/// metresPerUnit. STL holds single precision, the others nine digits, which is what importers keep. Throws InputError
/// when the extension is another or the file can't be written.
void writeMesh(const std::string& path, const TriangleMesh& mesh, double metresPerUnit = 1);

}  // namespace granular
