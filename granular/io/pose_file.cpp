#include "granular/io/pose_file.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <string>

#include "granular/core/errors.h"
#include "granular/io/output_file.h"

namespace granular {
namespace {

/// The numbers of a line up to a comment; throws if something else stands there.
std::vector<double> splitNumbers(std::string_view line, const std::string& place) {
  std::vector<double> numbers;
  line = line.substr(0, line.find('#'));
  constexpr std::string_view separators = " \t,\r";
  for (std::size_t at = line.find_first_not_of(separators); at != std::string_view::npos;
       at = line.find_first_not_of(separators, at)) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    const std::string_view word = line.substr(at, end - at);
    double& value = numbers.emplace_back();
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || stop != digits.data() + digits.size() || !std::isfinite(value))
      throw InputError(fmt::format("{}: \"{}\" is not a finite number", place, word));
    at = end;
  }
  return numbers;
}

GroupPose makePose(const std::vector<double>& n, int groupCount, const std::string& place) {
  if (n.size() != 7 && n.size() != 8)
    throw InputError(fmt::format("{}: {} numbers; a pose has 7 or 8: x y z qw qx qy qz [group]", place, n.size()));
  GroupPose result;
  result.pose.x = {n[0], n[1], n[2]};
  result.pose.q = Quat(n[3], n[4], n[5], n[6]);
  const double length = result.pose.q.norm();
  if (std::abs(length - 1) > 1e-3)
    throw InputError(fmt::format("{}: the quaternion's length is {:g}, it must be 1", place, length));
  result.pose.q.normalize();
  if (n.size() == 7) return result;
  if (n[7] != std::floor(n[7]) || n[7] < 0 || n[7] >= groupCount)
    throw InputError(fmt::format("{}: group {:g}; the scene has groups 0 to {}", place, n[7], groupCount - 1));
  result.group = static_cast<int>(n[7]);
  return result;
}

}  // namespace

std::vector<GroupPose> readPoseFile(const std::filesystem::path& path, int groupCount) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path))
    throw InputError(fmt::format("{}: the poses can't be read: no such file", path.string()));
  std::vector<GroupPose> poses;
  double stated = -1;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string place = fmt::format("{}:{}", path.string(), number);
    const std::vector<double> numbers = splitNumbers(line, place);
    if (numbers.empty()) continue;
    if (poses.empty() && stated < 0 && numbers.size() == 3)
      stated = numbers[0];
    else
      poses.push_back(makePose(numbers, groupCount, place));
  }
  if (stated >= 0 && stated != static_cast<double>(poses.size()))
    throw InputError(fmt::format("{}: states {:g} poses, but has {}", path.string(), stated, poses.size()));
  if (poses.empty()) throw InputError(fmt::format("{}: holds no pose", path.string()));
  return poses;
}

void writePoseFile(const std::filesystem::path& path, const std::vector<GroupPose>& poses) {
  OutputFile file(path);
  file.write("# x y z qw qx qy qz group; m, body to world\n");
  for (const GroupPose& p : poses)
    file.write(fmt::format("{} {} {} {} {} {} {} {}\n", p.pose.x.x(), p.pose.x.y(), p.pose.x.z(), p.pose.q.w(),
                           p.pose.q.x(), p.pose.q.y(), p.pose.q.z(), p.group));
  file.finish();
}

}  // namespace granular
