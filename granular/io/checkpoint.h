// Archives on disk, as HDF5: one data set per column, each with its unit and description as attributes.
//
// HDF5 reads damaged files wrongly without complaint. The file therefore starts with a 512-byte block of text (HDF5's
// user block) that states the format, its version, the length and the SHA-256 of everything behind it; that is checked
// before HDF5 sees a byte. A file is written under another name, flushed to the disk, and then renamed, so that a crash
// leaves either the old file or the new one; the one before is kept.
#pragma once

#include <filesystem>

#include "granular/io/archive.h"

namespace granular {

/// Version of the file format; a file of another version is refused.
inline constexpr int checkpointVersion = 11;

/// Writes folder/checkpoint.h5; what had that name becomes folder/checkpoint_previous.h5. Throws InputError with the
/// reason if the file can't be written whole, for instance on a full disk; then both are as they were.
void saveCheckpoint(const std::filesystem::path& folder, const Archive& archive);

/// Reads a checkpoint, or the newest of a folder. Throws InputError with the reason (missing, not a checkpoint, another
/// version, cut short, damaged), naming the checkpoint before it where there is one.
Archive loadCheckpoint(const std::filesystem::path& fileOrFolder);

/// The folder in which a run goes on that is resumed from a file or a folder.
std::filesystem::path checkpointFolder(const std::filesystem::path& fileOrFolder);

}  // namespace granular
