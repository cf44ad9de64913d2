// Poses as text: one particle per line, "x y z qw qx qy qz [group]", separated by blanks, tabs or commas; # starts a
// comment. Lengths in m, body to world; the group counts the scene's [[particles]] from 0. A first line of three
// numbers "count ... ..." that states how many poses follow is accepted and its count checked.
#pragma once

#include <filesystem>
#include <vector>

#include "granular/core/math.h"

namespace granular {

struct GroupPose {
  Pose pose;
  int group = 0;
};

/// Throws InputError naming file, line and what is wrong: no such file, wrong number of columns, not a number, a
/// quaternion that is not of length 1 within 1e-3, a group not below groupCount, another count than stated, no pose at
/// all.
std::vector<GroupPose> readPoseFile(const std::filesystem::path& path, int groupCount);

/// Writes the same, with all digits. Throws InputError if the file can't be written.
void writePoseFile(const std::filesystem::path& path, const std::vector<GroupPose>& poses);

}  // namespace granular
