#include "granular/io/pose_file.h"

#include <unistd.h>

#include <fstream>

#include "granular/core/errors.h"
#include "granular/core/random.h"
#include "granular/io/output_file.h"
#include "scratch_folder.h"

namespace granular {
namespace {

class PoseFileTest : public ScratchFolder {
 protected:
  std::string errorOf(const std::string& text) const {
    std::ofstream(folder / "poses.txt") << text;
    try {
      readPoseFile(folder / "poses.txt", 2);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(PoseFileTest, ReadsBlanksCommasCommentsAndGroups) {
  std::ofstream(folder / "poses.txt") << "# x y z qw qx qy qz group\n\n0 0 0.1 1 0 0 0\n"
                                         "1e-3, 2e-3, +3e-3, 0.70710678, 0, 0.70710678, 0, 1 # turned\n";
  const std::vector<GroupPose> poses = readPoseFile(folder / "poses.txt", 2);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].pose.x, Vec3(0, 0, 0.1));
  EXPECT_EQ(poses[0].group, 0);
  EXPECT_EQ(poses[1].pose.x, Vec3(1e-3, 2e-3, 3e-3));
  EXPECT_EQ(poses[1].group, 1);
  EXPECT_NEAR(poses[1].pose.q.norm(), 1, 1e-15);
  EXPECT_NEAR((poses[1].pose.q * Vec3::UnitX() + Vec3::UnitZ()).norm(), 0, 1e-8);
}

TEST_F(PoseFileTest, ReadsTheSettledCubes) {
  const std::filesystem::path file =
      std::filesystem::path(GRANULAR_SOURCE_DIR) / "../shared/peers/common/cubes_packed_1000.txt";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const std::vector<GroupPose> poses = readPoseFile(file, 1);
  EXPECT_EQ(poses.size(), 1000u);
  for (const GroupPose& p : poses) EXPECT_LT(std::abs(p.pose.x.x()), 0.03135 / 2);
}

TEST_F(PoseFileTest, WritesWhatItReads) {
  Random random(2);
  std::vector<GroupPose> poses(50);
  for (GroupPose& p : poses) p = {{random.direction(), random.rotation()}, static_cast<int>(random.below(2))};
  writePoseFile(folder / "poses.txt", poses);
  const std::vector<GroupPose> back = readPoseFile(folder / "poses.txt", 2);
  ASSERT_EQ(back.size(), poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_EQ(back[k].pose.x, poses[k].pose.x);
    EXPECT_NEAR((back[k].pose.q.coeffs() - poses[k].pose.q.coeffs()).norm(), 0, 1e-15);
    EXPECT_EQ(back[k].group, poses[k].group);
  }
}

TEST_F(PoseFileTest, EveryFaultNamesItsLine) {
  EXPECT_NE(errorOf("0 0 0 1 0 0 0\n0 0 0 1 0 0\n").find("poses.txt:2: 6 numbers"), std::string::npos);
  EXPECT_NE(errorOf("0 0 zero 1 0 0 0\n").find(":1: \"zero\" is not a finite number"), std::string::npos);
  EXPECT_NE(errorOf("0 0 nan 1 0 0 0\n").find("\"nan\" is not"), std::string::npos);
  EXPECT_NE(errorOf("0 0 0 1 1 0 0\n").find("length is 1.41421"), std::string::npos);
  EXPECT_NE(errorOf("0 0 0 1 0 0 0 2\n").find("group 2; the scene has groups 0 to 1"), std::string::npos);
  EXPECT_NE(errorOf("2 0.1 0.1\n0 0 0 1 0 0 0\n").find("states 2 poses, but has 1"), std::string::npos);
  EXPECT_NE(errorOf("# nothing\n").find("holds no pose"), std::string::npos);
  EXPECT_THROW(readPoseFile(folder / "none.txt", 1), InputError);
}

using OutputFileTest = ScratchFolder;

TEST_F(OutputFileTest, FolderThatCannotBeUsedIsNamedWithTheReason) {
  prepareOutputFolder(folder / "a/b");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b"));
  EXPECT_TRUE(std::filesystem::is_empty(folder / "a/b"));
  std::ofstream(folder / "file") << "x";
  EXPECT_THROW(prepareOutputFolder(folder / "file"), InputError);
  EXPECT_THROW(prepareOutputFolder(folder / "file/below"), InputError);
  EXPECT_THROW(prepareOutputFolder("/proc/granular"), InputError);
  if (geteuid() == 0) return;  // root may write anywhere
  std::filesystem::permissions(folder / "a/b", std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_THROW(prepareOutputFolder(folder / "a/b"), InputError);
  std::filesystem::permissions(folder / "a/b", std::filesystem::perms::owner_all);
}

TEST_F(OutputFileTest, UnfinishedFileLeavesTheOldOne) {
  OutputFile first(folder / "r.txt");
  first.write("old");
  first.finish();
  {
    OutputFile second(folder / "r.txt");
    second.write("ne");
  }
  std::string text;
  std::ifstream(folder / "r.txt") >> text;
  EXPECT_EQ(text, "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()), 1);
}

}  // namespace
}  // namespace granular
