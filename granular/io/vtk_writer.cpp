#include "granular/io/vtk_writer.h"

#include <fmt/format.h>

#include <bit>
#include <cassert>
#include <numeric>
#include <unordered_map>

#include "granular/io/output_file.h"
#include "granular/shape/clump.h"

namespace granular {
namespace {

static_assert(std::endian::native == std::endian::little, "appended data are written as they lie in memory");

constexpr std::string_view typeName(float) { return "Float32"; }
constexpr std::string_view typeName(double) { return "Float64"; }
constexpr std::string_view typeName(std::int32_t) { return "Int32"; }
constexpr std::string_view typeName(std::int64_t) { return "Int64"; }

/// The XML elements of a file, and behind them the bytes that they point into.
class AppendedFile {
 public:
  void addText(std::string_view text) { xml += text; }

  template <class T>
  void addArray(std::string_view name, const std::vector<T>& values, int components) {
    xml += fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        typeName(T{}), escape(name), components, bytes.size());
    const std::uint64_t size = values.size() * sizeof(T);
    append(&size, sizeof size);
    append(values.data(), size);
  }

  void addArrays(std::string_view element, const std::vector<VtkArray>& arrays, [[maybe_unused]] std::size_t tuples) {
    xml += fmt::format("<{}>\n", element);
    for (const VtkArray& array : arrays) {
      assert(array.tuples() == tuples);
      std::visit([&](const auto& values) { addArray(array.name, values, array.components); }, array.values);
    }
    xml += fmt::format("</{}>\n", element);
  }

  void write(const std::filesystem::path& path, std::string_view type) const {
    OutputFile file(path);
    file.write(
        fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" "
                    "header_type=\"UInt64\">\n{}<AppendedData encoding=\"raw\">\n_",
                    type, xml));
    file.write(bytes);
    file.write("\n</AppendedData>\n</VTKFile>\n");
    file.finish();
  }

 private:
  std::string xml;
  std::vector<std::byte> bytes;

  void append(const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  }

  static std::string escape(std::string_view name) {
    std::string text;
    for (const char c : name) {
      if (c == '<' || c == '>' || c == '&' || c == '"')
        text += fmt::format("&#{};", static_cast<int>(c));
      else
        text += c;
    }
    return text;
  }
};

/// Connectivity and offsets of cells of one size.
template <std::size_t N>
void addCells(AppendedFile& file, std::string_view element, const std::vector<std::array<int, N>>& cells) {
  std::vector<std::int64_t> corners, offsets;
  corners.reserve(N * cells.size());
  for (const auto& cell : cells) {
    corners.insert(corners.end(), cell.begin(), cell.end());
    offsets.push_back(static_cast<std::int64_t>(corners.size()));
  }
  file.addText(fmt::format("<{}>\n", element));
  file.addArray("connectivity", corners, 1);
  file.addArray("offsets", offsets, 1);
  file.addText(fmt::format("</{}>\n", element));
}

/// The array with tuple k repeated counts[k] times.
VtkArray repeatTuples(const VtkArray& array, const std::vector<std::size_t>& counts) {
  VtkArray result{array.name, {}, array.components};
  std::visit(
      [&](const auto& values) {
        std::decay_t<decltype(values)> repeated;
        const auto width = array.components;
        auto tuple = values.begin();
        for (const std::size_t count : counts) {
          for (std::size_t n = 0; n < count; ++n) repeated.insert(repeated.end(), tuple, tuple + width);
          tuple += width;
        }
        result.values = std::move(repeated);
      },
      array.values);
  return result;
}

}  // namespace

std::size_t VtkArray::tuples() const {
  return std::visit([&](const auto& v) { return v.size() / static_cast<std::size_t>(components); }, values);
}

void writePolyData(const std::filesystem::path& path, const VtkPolyData& data) {
  // Single precision for points: a picture of a bed needs no more.
  std::vector<float> points;
  points.reserve(3 * data.points.size());
  for (const Vec3& p : data.points)
    for (int k = 0; k < 3; ++k) points.push_back(static_cast<float>(p[k]));

  AppendedFile file;
  file.addText(
      fmt::format("<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" "
                  "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
                  data.points.size(), data.lines.size(), data.triangles.size()));
  file.addArrays("PointData", data.pointArrays, data.points.size());
  file.addArrays("CellData", data.cellArrays, data.lines.size() + data.triangles.size());
  file.addText("<Points>\n");
  file.addArray("points", points, 3);
  file.addText("</Points>\n");
  addCells(file, "Lines", data.lines);
  addCells(file, "Polys", data.triangles);
  file.addText("</Piece>\n</PolyData>\n");
  file.write(path, "PolyData");
}

namespace {

TriangleMesh visibleSurface(const Shape& shape, int resolution) {
  const Clump* clump = asClump(shape);
  return clump ? clump->outerSurface(resolution) : shape.surface(resolution);
}

}  // namespace

VtkPolyData makeSurfaces(std::span<const Shape* const> shapes, std::span<const Frame> frames,
                         std::span<const VtkArray> particleArrays, int resolution, double scale) {
  VtkPolyData data;
  std::unordered_map<const Shape*, TriangleMesh> meshes;  // each shape is triangulated once
  std::vector<std::size_t> counts;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    auto [found, isNew] = meshes.try_emplace(shapes[k]);
    if (isNew) found->second = visibleSurface(*shapes[k], resolution);
    const TriangleMesh& mesh = found->second;
    const int first = static_cast<int>(data.points.size());
    for (const Vec3& p : mesh.vertices) data.points.push_back(frames[k].toWorld(scale * p));
    for (const auto& t : mesh.triangles) data.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    counts.push_back(mesh.triangles.size());
  }
  for (const VtkArray& array : particleArrays) {
    assert(array.tuples() == shapes.size());
    data.cellArrays.push_back(repeatTuples(array, counts));
  }
  return data;
}

VtkPolyData makeForceNetwork(const Bed& bed) {
  VtkPolyData data;
  std::vector<double> force, normalForce, overlap;
  for (const BedContact& c : bed.contacts) {
    const Vec3& from = bed.frames[static_cast<std::size_t>(c.a)].x;
    Vec3 to = c.b < 0 ? c.point : bed.frames[static_cast<std::size_t>(c.b)].x;
    // A neighbour across a repeating boundary would draw a line through the whole vessel: end at the contact point.
    if ((to - c.point).norm() > (bed.vessel.hi - bed.vessel.lo).norm() / 4 && bed.vessel.kind == Vessel::Kind::periodic)
      to = c.point;
    const int first = static_cast<int>(data.points.size());
    data.points.push_back(from);
    data.points.push_back(to);
    data.lines.push_back({first, first + 1});
    force.push_back(c.force.norm());
    normalForce.push_back(-c.force.dot(c.normal));
    overlap.push_back(c.overlap);
  }
  data.cellArrays = {{"force_N", force}, {"normal_force_N", normalForce}, {"overlap_m", overlap}};
  return data;
}

void writeVoxels(const std::filesystem::path& path, const VoxelField& field) {
  std::vector<float> porosity(field.solid.size(), 1);
  for (std::size_t k = 0; k < porosity.size(); ++k)
    if (field.vessel[k] > 0) porosity[k] = 1 - field.solid[k] / field.vessel[k];
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", field.count[0], field.count[1], field.count[2]);
  AppendedFile file;
  file.addText(
      fmt::format("<ImageData WholeExtent=\"{0}\" Origin=\"{1} {2} {3}\" Spacing=\"{4} {4} {4}\">\n"
                  "<Piece Extent=\"{0}\">\n",
                  extent, field.origin.x(), field.origin.y(), field.origin.z(), field.edge));
  file.addArrays("CellData", {{"solid", field.solid}, {"vessel", field.vessel}, {"porosity", porosity}},
                 field.solid.size());
  file.addText("</Piece>\n</ImageData>\n");
  file.write(path, "ImageData");
}

void FrameSeries::add(double time, const std::filesystem::path& file) {
  frames.push_back({time, file.lexically_relative(path.parent_path()).generic_string()});
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const Entry& frame : frames)
    text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", frame.time, frame.file);
  text += "</Collection>\n</VTKFile>\n";
  OutputFile collection(path);
  collection.write(text);
  collection.finish();
}

}  // namespace granular
