#include "granular/io/checkpoint.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "granular/core/random.h"
#include "granular/io/digest.h"
#include "scratch_folder.h"

namespace granular {
namespace {

namespace fs = std::filesystem;

struct Spring {
  Vec3 stretch = Vec3::Zero();
  double twist = 0;
  std::int32_t kind = 0;
};

enum class Phase : std::uint8_t { pouring, resting };

struct State {
  double time = 0;
  std::int64_t steps = 0;
  bool settled = false;
  std::string scene, nothing;
  std::vector<std::string> names;
  std::vector<Vec3> x;
  std::vector<Quat> q;
  std::vector<std::int64_t> id;
  std::vector<std::uint8_t> phase;
  std::vector<double> empty;
  std::array<std::uint64_t, 4> random{};
  Vec3 gravity = Vec3::Zero();
  std::vector<Spring> springs;
  Phase now = Phase::pouring;
  std::vector<Phase> phases;
};

void describe(Archive& archive, State& s) {
  archive.visit("time", s.time, {"s", "simulated time"});
  archive.visit("steps", s.steps);
  archive.visit("settled", s.settled);
  archive.visit("scene", s.scene, {"", "the scene file"});
  archive.visit("nothing", s.nothing);
  archive.visit("names", s.names);
  archive.inGroup("bodies", [&] {
    archive.visit("x", s.x, {"m", "position"});
    archive.visit("q", s.q, {"", "orientation x y z w"});
    archive.visit("id", s.id);
    archive.visit("phase", s.phase);
    archive.visit("empty", s.empty);
  });
  archive.visit("random", s.random);
  archive.visit("gravity", s.gravity, {"m/s^2"});
  archive.inGroup("springs", [&] {
    archive.visitMember("stretch", s.springs, &Spring::stretch, {"m"});
    archive.visitMember("twist", s.springs, &Spring::twist, {"rad"});
    archive.visitMember("kind", s.springs, &Spring::kind);
  });
  archive.visitEnum("now", s.now, Phase::resting);
  archive.visit("phases", s.phases);
}

State makeState(int count) {
  Random random(5);
  State s;
  s.time = 0.1;
  s.steps = 1234567890123;
  s.settled = true;
  s.scene = "name = \"bed\"\n[vessel]\n";
  s.names = {"glass", "", "steel ball"};
  for (int k = 0; k < count; ++k) {
    s.x.push_back(random.direction());
    s.q.push_back(random.rotation());
    s.id.push_back(7 * k);
    s.phase.push_back(static_cast<std::uint8_t>(k % 3));
    s.springs.push_back({random.direction(), random.uniform(), k});
  }
  s.random = random.state();
  s.gravity = {0, 0, -9.81};
  s.now = Phase::resting;
  s.phases = {Phase::resting, Phase::pouring};
  return s;
}

Archive save(State state) {
  Archive archive;
  archive.visitGroup("run", state);
  return archive;
}

class CheckpointTest : public ScratchFolder {
 protected:
  fs::path file() const { return folder / "checkpoint.h5"; }

  std::string errorOf() const {
    try {
      loadCheckpoint(folder);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  void damage(std::streamoff at, char value) const {
    std::fstream stream(file(), std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(at);
    stream.put(value);
  }
};

TEST(Digest, Sha256OfTheStandardsExamples) {
  const auto hash = [](std::string_view text) {
    Digest digest;
    digest.add(std::as_bytes(std::span(text)));
    return digest.finishHex();
  };
  EXPECT_EQ(hash(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hash("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hash("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hash(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Digest, DoesNotDependOnHowTheMessageIsCut) {
  const std::string text(1000, 'x');
  Digest whole, parts;
  whole.add(std::as_bytes(std::span(text)));
  for (std::size_t at = 0, piece = 1; at < text.size(); at += piece, piece = piece % 130 + 1)
    parts.add(std::as_bytes(std::span(text).subspan(at, std::min(piece, text.size() - at))));
  EXPECT_EQ(whole.finishHex(), parts.finishHex());
}

TEST_F(CheckpointTest, RestoresEveryBit) {
  for (const int count : {0, 1, 1000}) {
    const Archive saved = save(makeState(count));
    saveCheckpoint(folder, saved);
    Archive loaded = loadCheckpoint(folder);
    EXPECT_EQ(loaded.digest(), saved.digest());
    State state;
    loaded.visitGroup("run", state);
    loaded.requireAllRead();
    EXPECT_EQ(state.scene, makeState(0).scene);
    EXPECT_EQ(state.names, makeState(0).names);
    EXPECT_EQ(state.nothing, "");
    EXPECT_EQ(state.now, Phase::resting);
    EXPECT_EQ(state.phases, makeState(0).phases);
    EXPECT_EQ(state.springs.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(save(state).digest(), saved.digest());
  }
}

TEST_F(CheckpointTest, EqualStatesMakeEqualFiles) {
  saveCheckpoint(folder, save(makeState(10)));
  saveCheckpoint(folder, save(makeState(10)));
  const auto read = [](const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_EQ(read(file()), read(folder / "checkpoint_previous.h5"));
}

TEST_F(CheckpointTest, DigestSeesTheLastBit) {
  State state = makeState(10);
  const std::string before = save(state).digest();
  state.x[3].y() = std::nextafter(state.x[3].y(), 2);
  EXPECT_NE(save(state).digest(), before);
}

TEST_F(CheckpointTest, KeepsTheOneBeforeAndLeavesNothingElse) {
  for (int k = 1; k <= 3; ++k) {
    State state = makeState(3);
    state.steps = k;
    saveCheckpoint(folder, save(state));
  }
  State state;
  loadCheckpoint(folder).visitGroup("run", state);
  EXPECT_EQ(state.steps, 3);
  loadCheckpoint(folder / "checkpoint_previous.h5").visitGroup("run", state);
  EXPECT_EQ(state.steps, 2);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
}

TEST_F(CheckpointTest, IsAnHdf5FileThatDescribesItself) {
  saveCheckpoint(folder, save(makeState(4)));
  const hid_t opened = H5Fopen(file().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(opened, 0);
  const hid_t x = H5Dopen2(opened, "run/bodies/x", H5P_DEFAULT);
  ASSERT_GE(x, 0);
  hsize_t shape[2] = {0, 0};
  const hid_t space = H5Dget_space(x);
  EXPECT_EQ(H5Sget_simple_extent_dims(space, shape, nullptr), 2);
  EXPECT_EQ(shape[0], 4u);
  EXPECT_EQ(shape[1], 3u);
  EXPECT_GT(H5Aexists(x, "unit"), 0);
  EXPECT_GT(H5Aexists(x, "description"), 0);
  H5Sclose(space);
  H5Dclose(x);
  H5Fclose(opened);
}

TEST_F(CheckpointTest, TruncatedFileIsRefusedAndTheOneBeforeNamed) {
  saveCheckpoint(folder, save(makeState(100)));
  saveCheckpoint(folder, save(makeState(100)));
  const auto size = fs::file_size(file());
  for (const std::uintmax_t length :
       {size - 1, size / 2, std::uintmax_t{513}, std::uintmax_t{512}, std::uintmax_t{100}}) {
    fs::resize_file(file(), length);
    const std::string message = errorOf();
    EXPECT_NE(message.find("cut short"), std::string::npos) << message;
    EXPECT_NE(message.find("checkpoint_previous.h5"), std::string::npos) << message;
  }
}

TEST_F(CheckpointTest, ForeignFileIsRefused) {
  std::ofstream(file()) << "\x89HDF\r\n\x1a\n of another program";
  EXPECT_NE(errorOf().find("not a checkpoint of this program"), std::string::npos);
  fs::resize_file(file(), 0);
  EXPECT_NE(errorOf().find("not a checkpoint of this program"), std::string::npos);
  fs::remove(file());
  EXPECT_NE(errorOf().find("no such checkpoint"), std::string::npos);
}

TEST_F(CheckpointTest, OtherVersionIsRefused) {
  saveCheckpoint(folder, save(makeState(1)));
  static_assert(checkpointVersion >= 10 && checkpointVersion < 100);
  damage(20, '0');
  const std::string message = errorOf();
  const std::string versions = "format version " + std::to_string(checkpointVersion % 10) + ", this program reads " +
                               std::to_string(checkpointVersion);
  EXPECT_NE(message.find(versions), std::string::npos) << message;
}

TEST_F(CheckpointTest, EveryDamagedByteIsNoticed) {
  saveCheckpoint(folder, save(makeState(20)));
  const auto size = static_cast<std::uint64_t>(fs::file_size(file()));
  const fs::path whole = folder / "whole";
  fs::copy_file(file(), whole);
  Random random(11);
  for (int k = 0; k < 300; ++k) {
    fs::copy_file(whole, file(), fs::copy_options::overwrite_existing);
    // Half of the damage in the first block, which is small but decides.
    const auto at = static_cast<std::streamoff>(random.below(k % 2 ? size : 512));
    std::ifstream stream(file(), std::ios::binary);
    stream.seekg(at);
    const char before = static_cast<char>(stream.get());
    stream.close();
    damage(at, static_cast<char>(before ^ (1 << random.below(8))));
    EXPECT_NE(errorOf(), "no error") << "byte " << at;
  }
}

TEST_F(CheckpointTest, ThereIsOneUnderTheFirstNameAtAnyMoment) {
  saveCheckpoint(folder, save(makeState(3)));
  // Somebody who looks all the time while another process saves.
  const pid_t writer = fork();
  if (writer == 0) {
    for (int k = 0; k < 200; ++k) saveCheckpoint(folder, save(makeState(3)));
    _exit(0);
  }
  ASSERT_GT(writer, 0);
  std::uint64_t looks = 0, misses = 0;
  int status = 0;
  while (waitpid(writer, &status, WNOHANG) == 0) {
    ++looks;
    misses += access(file().c_str(), R_OK) != 0;
  }
  EXPECT_EQ(status, 0);
  EXPECT_GT(looks, 100u);
  EXPECT_EQ(misses, 0u);
}

/// A limit on the size of any file that this process writes, as if the disk were full there.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    handler = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit limit{bytes, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before{};
  void (*handler)(int) = SIG_DFL;
};

TEST_F(CheckpointTest, ThatCannotBeWrittenWholeLeavesTheLastTwoAsTheyWere) {
  saveCheckpoint(folder, save(makeState(3)));
  saveCheckpoint(folder, save(makeState(4)));
  const Archive large = save(makeState(20000));
  for (const rlim_t room : {0, 100, 512, 3000, 40000, 700000, 1500000}) {
    std::string message = "no error";
    {
      const FileSizeLimit limit(room);
      try {
        saveCheckpoint(folder, large);
      } catch (const InputError& error) {
        message = error.what();
      }
    }
    EXPECT_NE(message.find("can't be written"), std::string::npos) << message;
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    EXPECT_NE(message.find("the one before stands"), std::string::npos) << message;
    EXPECT_EQ(loadCheckpoint(folder).digest(), save(makeState(4)).digest()) << room;
    EXPECT_EQ(loadCheckpoint(folder / "checkpoint_previous.h5").digest(), save(makeState(3)).digest()) << room;
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2) << room;
  }
  // With room again the next one is written.
  saveCheckpoint(folder, large);
  EXPECT_EQ(loadCheckpoint(folder).digest(), large.digest());
}

/// Runs body() in a process of its own, and returns what it returned; 99 if it threw.
template <class Body>
int resultInChild(Body&& body) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      _exit(body());
    } catch (const std::exception&) {
      _exit(99);
    }
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(CheckpointTest, OnAFullDiskIsRefusedAndTheLastOneStands) {
  // A disk of 256 KiB of this test's own, seen by one process alone; only some systems permit that.
  const int result = resultInChild([&] {
    const uid_t user = getuid(), group = getgid();
    if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return 77;
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << "0 " << user << " 1\n";
    std::ofstream("/proc/self/gid_map") << "0 " << group << " 1\n";
    if (mount("none", folder.c_str(), "tmpfs", 0, "size=256k") != 0) return 77;
    saveCheckpoint(folder, save(makeState(3)));
    try {
      saveCheckpoint(folder, save(makeState(20000)));
      return 1;
    } catch (const InputError& error) {
      if (std::string(error.what()).find("No space left on device") == std::string::npos) return 2;
    }
    return loadCheckpoint(folder).digest() == save(makeState(3)).digest() ? 0 : 3;
  });
  if (result == 77) GTEST_SKIP() << "no disk may be mounted here";
  EXPECT_EQ(result, 0) << "1: no error, 2: another reason, 3: the last checkpoint is gone, 99: another error";
}

TEST_F(CheckpointTest, FolderThatCannotBeWrittenIsNamed) {
  EXPECT_THROW(saveCheckpoint(folder / "nowhere", save(makeState(1))), InputError);
}

TEST(Archive, MissingWrongAndUnknownDataAreNamed) {
  State state = makeState(2);
  Archive saved;
  saved.inGroup("run", [&] { saved.visit("time", state.time); });
  Archive loaded = saved.reopened();
  try {
    loaded.visitGroup("run", state);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("run/steps is missing"), std::string::npos) << error.what();
  }
  std::string text;
  Archive other = saved.reopened();
  EXPECT_THROW(other.visit("run/time", text), InputError);
  EXPECT_THROW(other.requireAllRead(), InputError);
  EXPECT_TRUE(other.has("run"));
  EXPECT_TRUE(other.has("run/time"));
  EXPECT_FALSE(other.has("ru"));
}

TEST(Archive, ColumnsOfUnequalLengthAreRefused) {
  std::vector<double> three(3), four(4);
  Archive saved;
  saved.visit("twist", three);
  std::vector<Vec3> stretch(4);
  saved.visit("stretch", stretch);
  Archive loaded = saved.reopened();
  std::vector<Spring> springs;
  loaded.visitMember("twist", springs, &Spring::twist);
  EXPECT_THROW(loaded.visitMember("stretch", springs, &Spring::stretch), InputError);
}

TEST(Archive, EnumerationOutOfRangeIsRefused) {
  Archive saved;
  std::int32_t number = 2;
  saved.visit("now", number);
  Archive loaded = saved.reopened();
  Phase phase = Phase::pouring;
  EXPECT_THROW(loaded.visitEnum("now", phase, Phase::resting), InputError);
}

}  // namespace
}  // namespace granular
