// What a checkpoint says is checked before anything is looked up by it: a file whose digest is right, but whose lists
// contradict each other, is refused and never followed into memory that is not there.
#include "granular/run/world_check.h"

#include "granular/core/random.h"
#include "run/resume_fixture.h"

namespace granular {
namespace {

class SpoiltWorld : public RunTest {
 protected:
  /// Touching bodies of every kind of memory, some of them asleep.
  PackingRun makeBed() {
    const std::string groups = R"(
[[particles]]
shape = "sphere"
radius = "1.5 mm"
[[particles]]
shape = "cuboid"
half_lengths = ["1.2 mm", "1.2 mm", "1.5 mm"]
[[particles]]
shape = "polyhedron"
vertices = [["2 mm", 0, 0], ["-2 mm", 0, 0], [0, "2 mm", 0], [0, "-2 mm", 0], [0, 0, "2 mm"], [0, 0, "-1 mm"]]
[[particles]]
shape = "cylinder"
radius = "1.2 mm"
height = "2.6 mm"
[[particles]]
shape = "clump"
radii = ["1 mm", "1.2 mm"]
centres = [[0, 0, 0], ["1.5 mm", 0, 0]]
)";
    std::ofstream poses(folder / "poses.txt");
    for (int k = 0; k < 30; ++k) {
      const int column = k % 3 - 1, row = k / 3 % 3 - 1, layer = k / 9;
      const double at[] = {4.2e-3 * column, 4.2e-3 * row, 3e-3 + 4.2e-3 * layer};
      poses << at[0] << ' ' << at[1] << ' ' << at[2] << " 1 0 0 0 " << k % 5 << '\n';
    }
    poses.close();
    return PackingRun(write(narrowBox + commonText + groups +
                            "[insertion]\nkind = \"poses\"\nfile = \"poses.txt\"\n[settle]\nkind = \"sleep\"\n"
                            "energy = 0.01\n"));
  }

  static std::string errorOf(World& world, std::map<std::string, DataSet> content) {
    Archive spoilt(std::move(content), "spoilt");
    try {
      describe(spoilt, world);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(SpoiltWorld, IsRefusedOrGoesOnWithoutReadingWhatIsNotThere) {
  PackingRun bed = makeBed();
  while (bed.world().time < 0.06) step(bed.world(), bed.timeStep());
  ASSERT_GT(bed.world().sleep.fallen, 0u);
  Archive saved;
  describe(saved, bed.world());
  std::vector<std::string> integers;
  for (const auto& [name, set] : saved.content()) {
    if (set.type != ElementType::float64 && !set.bytes.empty()) integers.push_back(name);
  }

  // One entry of an integer column becomes a number that is often wrong.
  Random random(3);
  int refused = 0, accepted = 0;
  constexpr int trials = 150;
  for (int k = 0; k < trials; ++k) {
    std::map<std::string, DataSet> content = saved.content();
    const std::string& name = integers[random.below(integers.size())];
    DataSet& set = content.at(name);
    const std::size_t size = elementSize(set.type), entry = random.below(set.bytes.size() / size);
    constexpr std::int64_t choices[] = {-1000000000, -2, -1, 0, 1, 2, 3, 5, 30, 31, 1000, 1 << 24, 0x7fffffff};
    const std::int64_t value = choices[random.below(std::size(choices))];
    std::memcpy(set.bytes.data() + entry * size, &value, size);
    SCOPED_TRACE(name + " at " + std::to_string(entry) + " = " + std::to_string(value));

    PackingRun other = makeBed();
    if (!errorOf(other.world(), std::move(content)).empty()) {
      ++refused;
      continue;
    }
    ++accepted;
    if (name.ends_with("proof")) continue;  // bytes of numbers, not indices
    for (int n = 0; n < 20; ++n) step(other.world(), other.timeStep());
    wakeAll(other.world());
    for (int n = 0; n < 20; ++n) step(other.world(), other.timeStep());
  }
  EXPECT_GT(refused, trials / 4);
  EXPECT_GT(accepted, trials / 20);
}

TEST_F(SpoiltWorld, WithAColumnOfAnotherLengthOrNoneIsRefused) {
  PackingRun bed = makeBed();
  while (bed.world().time < 0.06) step(bed.world(), bed.timeStep());
  Archive saved;
  describe(saved, bed.world());
  for (const auto& [name, set] : saved.content()) {
    SCOPED_TRACE(name);
    std::map<std::string, DataSet> without = saved.content();
    without.erase(name);
    PackingRun other = makeBed();
    EXPECT_NE(errorOf(other.world(), without), "");
    if (set.single || set.rows == 0) continue;
    // A row less, a row more. Lists that stand alone may have any length.
    if (name == "report/stage_seconds" || name == "memory/free" || name.starts_with("report/troubles")) continue;
    for (const std::size_t rows : {set.rows - 1, set.rows + 1}) {
      std::map<std::string, DataSet> changed = saved.content();
      DataSet& column = changed.at(name);
      column.bytes.resize(column.bytes.size() / column.rows * rows);
      column.rows = rows;
      EXPECT_NE(errorOf(other.world(), changed), "") << rows << " rows of " << set.rows;
    }
  }
}

TEST_F(SpoiltWorld, DocumentNamesEveryColumn) {
  PackingRun bed = makeBed();
  Archive archive;
  describe(archive, bed.world());
  std::ifstream file(std::string(GRANULAR_SOURCE_DIR) + "/docs/checkpoint.md");
  const std::string document{std::istreambuf_iterator<char>(file), {}};
  for (const auto& [name, set] : archive.content()) {
    if (name.starts_with("report/")) continue;
    const std::string leaf = name.substr(name.rfind('/') + 1);
    const bool named =
        document.find('`' + leaf + '`') != std::string::npos || document.find('/' + leaf + '`') != std::string::npos;
    EXPECT_TRUE(named) << name << " is not in docs/checkpoint.md";
  }
}

}  // namespace
}  // namespace granular
