// Generates the scan-like rocks of this folder: stretched icospheres, cut by random planes with rounded edges,
// roughened by gradient noise in octaves (Perlin, "Improving noise", 2002), one with a bite out of it, one cracked
// open, one with every kind of defect that the importer repairs. Each rock depends on its own seed alone.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "demos/exit_code.h"
#include "granular/core/random.h"
#include "granular/mesh/mesh_file.h"

namespace granular {
namespace {

using Triangle = std::array<int, 3>;

// What a rock looks like; lengths relative to its radius.
struct Recipe {
  std::uint64_t seed;
  int cuts;              // subdivisions of the icosahedron: 20 * 4^cuts triangles
  Vec3 axes;             // of the ellipsoid it starts from
  int planes;            // that cut pieces off
  double shallow, deep;  // where planes cut, as fractions of the extent in their direction
  double lumps, grain;   // amplitudes of coarse and fine noise
  double bite;           // radius of the balls that bite into two sides, relative to the extent there; 0: none
};

// A unit sphere of nearly equal triangles.
TriangleMesh makeSphere(int cuts) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  mesh.vertices = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                   {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& v : mesh.vertices) v.normalize();
  for (int cut = 0; cut < cuts; ++cut) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, isNew] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
      if (isNew) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& f : mesh.triangles) {
      const int ab = middle(f[0], f[1]), bc = middle(f[1], f[2]), ca = middle(f[2], f[0]);
      for (const Triangle& g :
           {Triangle{f[0], ab, ca}, Triangle{f[1], bc, ab}, Triangle{f[2], ca, bc}, Triangle{ab, bc, ca}}) {
        finer.push_back(g);
      }
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

// Gradient noise on the integer lattice, about -1 to 1.
class Noise {
 public:
  explicit Noise(Random& random) {
    for (Vec3& g : gradients) g = random.direction();
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
    for (std::size_t k = order.size() - 1; k > 0; --k) std::swap(order[k], order[random.below(k + 1)]);
  }

  double operator()(const Vec3& p) const {
    const Vec3 base(std::floor(p.x()), std::floor(p.y()), std::floor(p.z()));
    const Vec3 f = p - base;
    const Vec3 s = f.unaryExpr([](double t) { return t * t * t * (t * (6 * t - 15) + 10); });
    double sum = 0;
    for (int k = 0; k < 8; ++k) {
      const Vec3 corner(k & 1, (k >> 1) & 1, (k >> 2) & 1);
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) weight *= corner[axis] > 0 ? s[axis] : 1 - s[axis];
      sum += weight * gradientAt(base + corner).dot(f - corner);
    }
    return 1.5 * sum;
  }

  // Octaves of half the size and half the height.
  double octaves(const Vec3& p, int count) const {
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += std::ldexp((*this)(std::ldexp(1.0, k) * p + Vec3::Constant(17.3 * k)), -k);
    return sum;
  }

 private:
  const Vec3& gradientAt(const Vec3& corner) const {
    int hash = 0;
    for (int axis = 0; axis < 3; ++axis)
      hash = order[static_cast<std::size_t>((hash + static_cast<int>(corner[axis])) & 255)];
    return gradients[static_cast<std::size_t>(hash)];
  }
  std::array<Vec3, 256> gradients;
  std::array<int, 256> order{};
};

// The least of several distances, rounded where two are close.
double softMinimum(const std::vector<double>& values, double sharpness) {
  const double least = *std::min_element(values.begin(), values.end());
  double sum = 0;
  for (const double v : values) sum += std::exp(sharpness * (least - v));
  return least - std::log(sum) / sharpness;
}

// Distance along the unit direction u at which a ray from the origin enters a ball; infinite if it misses.
double enterBall(const Vec3& u, const Vec3& centre, double radius) {
  const double along = u.dot(centre);
  const double under = along * along - centre.squaredNorm() + radius * radius;
  return along > 0 && under > 0 ? along - std::sqrt(under) : infinity;
}

TriangleMesh makeRock(const Recipe& recipe, double size) {
  Random random(recipe.seed);
  const Noise noise(random);
  struct Plane {
    Vec3 normal;
    double offset;
  };
  std::vector<Plane> planes;
  for (int k = 0; k < recipe.planes; ++k) {
    const Vec3 normal = random.direction();
    planes.push_back({normal, random.uniform(recipe.deep, recipe.shallow) * recipe.axes.cwiseProduct(normal).norm()});
  }
  // Two bites, well apart.
  const Vec3 side = random.direction();
  const Vec3 otherSide = (perpendicular(side) - side).normalized();

  TriangleMesh mesh = makeSphere(recipe.cuts);
  for (Vec3& v : mesh.vertices) {
    // Along the direction of the stretched vertex: the ellipsoid, the planes before it, and noise on top.
    const Vec3 stretched = recipe.axes.cwiseProduct(v);
    const Vec3 u = stretched.normalized();
    std::vector<double> reach = {stretched.norm()};
    for (const Plane& plane : planes) {
      if (plane.normal.dot(u) > 0.05) reach.push_back(plane.offset / plane.normal.dot(u));
    }
    double r = softMinimum(reach, 30);
    r *= 1 + recipe.lumps * noise.octaves(1.7 * u, 3) + recipe.grain * noise.octaves(9 * u, 3);
    // Bites, from balls so far out that the surface meets them at a slope; rims as rounded as the edges.
    for (const Vec3& towards : {side, otherSide}) {
      const Vec3 place = recipe.axes.cwiseProduct(towards);
      const double entry = enterBall(u, 1.45 * place, recipe.bite * place.norm() * (1 + 0.03 * noise(4 * u)));
      if (entry < infinity) r = softMinimum({r, entry}, 30);
    }
    v = size * r * u;
  }
  return mesh;
}

void flip(Triangle& t) { std::swap(t[1], t[2]); }

// Puts in everything that is repaired; the counts stand in README.md.
void makeDirty(TriangleMesh& mesh, Random& random) {
  const auto newVertex = [&](const Vec3& p) {
    mesh.vertices.push_back(p);
    return static_cast<int>(mesh.vertices.size()) - 1;
  };
  const auto vertexOf = [&](std::size_t t, int k) -> Vec3 {
    return mesh.vertices[mesh.triangles[t][static_cast<std::size_t>(k)]];
  };
  // Different places of the list for different defects: 100 triangles apart at least.
  for (std::size_t k = 0; k < 23; ++k) {  // duplicate vertices
    const std::size_t t = 100 + 7 * k;
    mesh.triangles[t][0] = newVertex(vertexOf(t, 0));
  }
  for (int k = 0; k < 11; ++k) newVertex(0.01 * random.direction());  // unreferenced vertices
  for (std::size_t k = 0; k < 9; ++k) {                               // degenerate triangles
    const Triangle f = mesh.triangles[500 + k];
    mesh.triangles.push_back({f[0], f[0], f[1]});
  }
  for (std::size_t k = 0; k < 13; ++k) {
    const Triangle f = mesh.triangles[700 + 3 * k];
    mesh.triangles.push_back(f);
  }                                                                        // duplicate triangles
  for (std::size_t k = 0; k < 17; ++k) flip(mesh.triangles[900 + 6 * k]);  // flipped triangles
  for (std::size_t k = 0; k < 5; ++k) {                                    // slivers: a corner just inside an edge
    const std::size_t t = 1200 + 20 * k;
    const Triangle f = mesh.triangles[t];
    const int p = newVertex(0.4985 * vertexOf(t, 0) + 0.4985 * vertexOf(t, 1) + 0.003 * vertexOf(t, 2));
    mesh.triangles[t] = {f[0], f[1], p};
    mesh.triangles.push_back({f[1], f[2], p});
    mesh.triangles.push_back({f[2], f[0], p});
  }
  for (std::size_t k = 0; k < 4; ++k) {  // fins: one non-manifold and two open edges each
    const std::size_t t = 1500 + 30 * k;
    const Triangle f = mesh.triangles[t];
    mesh.triangles.push_back({f[0], f[1], newVertex(1.05 * vertexOf(t, 0))});
  }
  for (int k = 0; k < 3; ++k) {  // crumbs beside the rock: parts of 80 triangles
    TriangleMesh crumb = makeSphere(1);
    const Vec3 place = 0.05 * random.direction();
    const int first = static_cast<int>(mesh.vertices.size());
    for (const Vec3& v : crumb.vertices) newVertex(place + 0.001 * v);
    for (const Triangle& t : crumb.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

void makeAll(const std::filesystem::path& folder) {
  const auto write = [&](const std::string& name, const TriangleMesh& mesh, double unit = 1) {
    writeMesh((folder / name).string(), mesh, unit);
    std::printf("%s: %zu vertices, %zu triangles, %ju bytes\n", name.c_str(), mesh.vertices.size(),
                mesh.triangles.size(), static_cast<std::uintmax_t>(std::filesystem::file_size(folder / name)));
  };
  //                         seed cuts axes              planes shallow deep lumps grain bite
  const Recipe boulder = {11, 4, {1.0, 0.88, 0.78}, 12, 0.95, 0.72, 0.05, 0.010, 0};
  const Recipe shard = {23, 4, {1.9, 0.75, 0.60}, 9, 0.95, 0.70, 0.06, 0.012, 0};
  const Recipe slab = {37, 4, {1.2, 1.0, 0.36}, 8, 0.97, 0.80, 0.05, 0.012, 0};
  const Recipe bitten = {41, 4, {1.1, 0.95, 0.85}, 8, 0.96, 0.78, 0.08, 0.012, 1.02};
  const Recipe pebble = {53, 4, {1.0, 0.85, 0.65}, 5, 0.98, 0.85, 0.09, 0.004, 0};
  const Recipe cracked = {67, 4, {1.0, 0.9, 0.7}, 10, 0.95, 0.75, 0.06, 0.012, 0};
  const Recipe dirty = {71, 4, {1.15, 0.9, 0.8}, 11, 0.95, 0.74, 0.06, 0.010, 0};
  write("boulder.obj", makeRock(boulder, 0.030));
  write("shard.ply", makeRock(shard, 0.024));
  write("slab.obj", makeRock(slab, 0.028));
  write("bitten.obj", makeRock(bitten, 0.030));
  write("pebble_mm.stl", makeRock(pebble, 0.020), 1e-3);
  // A scan with a gap: sixteen triangles are missing.
  TriangleMesh open = makeRock(cracked, 0.026);
  open.triangles.erase(open.triangles.begin() + 1000, open.triangles.begin() + 1016);
  write("cracked.off", open);
  TriangleMesh soiled = makeRock(dirty, 0.027);
  Random random(dirty.seed + 1);
  makeDirty(soiled, random);
  write("dirty.obj", soiled);
}

}  // namespace
}  // namespace granular

namespace {

int parseAndRun(int argc, char** argv) {
  CLI::App app("Generates the scan-like rocks of meshes/: the same files on every run.");
  std::string folder = "meshes";
  app.add_option("--out", folder, "folder to write to")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::filesystem::create_directories(folder);
  granular::makeAll(folder);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("make_rocks", [&] { return parseAndRun(argc, argv); });
}
