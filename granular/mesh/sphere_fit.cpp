// A grid over the mesh says which cells are inside (parity of crossings along z) and how far each is from the outside
// (Felzenszwalb and Huttenlocher's distance transform, axis by axis). Every inside cell carries a candidate sphere; the
// volume that a set of spheres covers is submodular: a candidate's gain only shrinks as others are chosen. So the
// greedy choice needs to look again only at candidates whose last known gain is still the largest. The chosen centres
// are then moved by up to a cell, uphill in the exact distance from the triangles, which is the sphere's radius.
#include "granular/mesh/sphere_fit.h"

#include <algorithm>
#include <cassert>
#include <queue>

#include "granular/core/errors.h"

namespace granular {
namespace {

/// Squared distance of p from the triangle abc.
double squaredDistance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const Vec3 n = ab.cross(ac);
  const double nn = n.squaredNorm();
  if (nn > 0) {
    const double v = n.dot(ap.cross(ac)), w = n.dot(ab.cross(ap));  // barycentric, times nn
    if (v >= 0 && w >= 0 && v + w <= nn) {
      const double height = n.dot(ap);
      return height * height / nn;
    }
  }
  const auto toSegment = [&p](const Vec3& from, const Vec3& to) {
    const Vec3 d = to - from;
    const double length = d.squaredNorm();
    const double t = length > 0 ? std::clamp(d.dot(p - from) / length, 0.0, 1.0) : 0;
    return (p - from - t * d).squaredNorm();
  };
  return std::min({toSegment(a, b), toSegment(b, c), toSegment(c, a)});
}

double distanceFrom(const TriangleMesh& mesh, const Vec3& p) {
  double least = infinity;
  for (const auto& t : mesh.triangles) {
    least = std::min(least, squaredDistance(p, mesh.vertices[static_cast<std::size_t>(t[0])],
                                            mesh.vertices[static_cast<std::size_t>(t[1])],
                                            mesh.vertices[static_cast<std::size_t>(t[2])]));
  }
  return std::sqrt(least);
}

/// Cells of equal edge, one layer of them outside the mesh all round.
class Grid {
 public:
  Grid(const TriangleMesh& mesh, int along) {
    Aabb box;
    for (const Vec3& v : mesh.vertices) box.include(v);
    const Vec3 extent = box.hi - box.lo;
    edge = extent.maxCoeff() / along;
    for (int k = 0; k < 3; ++k) count[k] = static_cast<int>(std::ceil(extent[k] / edge)) + 2;
    origin = 0.5 * (box.lo + box.hi) - 0.5 * edge * count.cast<double>();
    inside.assign(size(), 0);
    markInside(mesh);
    measureDistances();
  }

  std::size_t size() const { return static_cast<std::size_t>(count.prod()); }
  std::size_t index(int i, int j, int k) const { return static_cast<std::size_t>((k * count.y() + j) * count.x() + i); }
  Eigen::Vector3i cellOf(std::size_t n) const {
    const int m = static_cast<int>(n);
    return {m % count.x(), m / count.x() % count.y(), m / (count.x() * count.y())};
  }
  Vec3 centreOf(const Eigen::Vector3i& cell) const {
    return origin + edge * (cell.cast<double>() + Vec3::Constant(0.5));
  }

  /// Calls visit(index) for all cells whose centre is in the ball.
  template <class Visit>
  void visitBall(const Vec3& centre, double radius, Visit&& visit) const {
    Eigen::Vector3i from, to;
    for (int k = 0; k < 3; ++k) {
      from[k] = std::max(0, static_cast<int>(std::ceil((centre[k] - radius - origin[k]) / edge - 0.5)));
      to[k] = std::min(count[k] - 1, static_cast<int>(std::floor((centre[k] + radius - origin[k]) / edge - 0.5)));
    }
    for (int k = from.z(); k <= to.z(); ++k)
      for (int j = from.y(); j <= to.y(); ++j)
        for (int i = from.x(); i <= to.x(); ++i)
          if ((centreOf({i, j, k}) - centre).squaredNorm() <= radius * radius) visit(index(i, j, k));
  }

  Eigen::Vector3i count;
  double edge = 0;
  Vec3 origin;
  std::vector<std::uint8_t> inside;
  std::vector<double> distance;  ///< of an inside cell's centre from the nearest outside one, m

 private:
  /// Along each column of cells the mesh is entered and left in turn.
  void markInside(const TriangleMesh& mesh) {
    std::vector<std::vector<double>> crossings(static_cast<std::size_t>(count.x() * count.y()));
    // Columns stand a hair off the middle of their cells, so that none runs along an edge of a regular mesh.
    const Vec2 hair = edge * Vec2(1.234567e-5, 2.345671e-5);
    for (const auto& t : mesh.triangles) {
      const Vec3 &a = mesh.vertices[static_cast<std::size_t>(t[0])], &b = mesh.vertices[static_cast<std::size_t>(t[1])],
                 &c = mesh.vertices[static_cast<std::size_t>(t[2])];
      const Vec2 ab = (b - a).head<2>(), ac = (c - a).head<2>();
      const double area = ab.x() * ac.y() - ab.y() * ac.x();
      if (area == 0) continue;
      const Vec3 lo = a.cwiseMin(b).cwiseMin(c), hi = a.cwiseMax(b).cwiseMax(c);
      const auto cellAt = [&](double x, int axis) { return static_cast<int>(std::floor((x - origin[axis]) / edge)); };
      for (int j = std::max(0, cellAt(lo.y(), 1) - 1); j <= std::min(count.y() - 1, cellAt(hi.y(), 1) + 1); ++j) {
        for (int i = std::max(0, cellAt(lo.x(), 0) - 1); i <= std::min(count.x() - 1, cellAt(hi.x(), 0) + 1); ++i) {
          const Vec2 p = centreOf({i, j, 0}).head<2>() + hair - a.head<2>();
          const double v = (p.x() * ac.y() - p.y() * ac.x()) / area, w = (ab.x() * p.y() - ab.y() * p.x()) / area;
          if (v < 0 || w < 0 || v + w > 1) continue;
          crossings[static_cast<std::size_t>(j * count.x() + i)].push_back(a.z() + v * (b.z() - a.z()) +
                                                                           w * (c.z() - a.z()));
        }
      }
    }
    for (int j = 0; j < count.y(); ++j) {
      for (int i = 0; i < count.x(); ++i) {
        std::vector<double>& column = crossings[static_cast<std::size_t>(j * count.x() + i)];
        std::sort(column.begin(), column.end());
        for (int k = 0; k < count.z(); ++k) {
          const double z = centreOf({i, j, k}).z();
          const auto below = std::lower_bound(column.begin(), column.end(), z) - column.begin();
          inside[index(i, j, k)] = below % 2 == 1;
        }
      }
    }
  }

  void measureDistances() {
    distance.assign(size(), 0);
    const double far = 1e12;
    for (std::size_t n = 0; n < size(); ++n) distance[n] = inside[n] ? far : 0;
    std::vector<double> line;
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int b = 0; b < count[v]; ++b) {
        for (int a = 0; a < count[u]; ++a) {
          Eigen::Vector3i cell;
          cell[u] = a;
          cell[v] = b;
          line.clear();
          for (cell[axis] = 0; cell[axis] < count[axis]; ++cell[axis])
            line.push_back(distance[index(cell.x(), cell.y(), cell.z())]);
          transformLine(line);
          for (cell[axis] = 0; cell[axis] < count[axis]; ++cell[axis])
            distance[index(cell.x(), cell.y(), cell.z())] = line[static_cast<std::size_t>(cell[axis])];
        }
      }
    }
    for (double& d : distance) d = edge * std::sqrt(d);
  }

  /// min over q of (p - q)^2 + f(q): the lower envelope of parabolas.
  static void transformLine(std::vector<double>& f) {
    const std::size_t n = f.size();
    std::vector<std::size_t> root(n);
    std::vector<double> begin(n + 1), result(n);
    std::size_t last = 0;
    begin[0] = -infinity;
    begin[1] = infinity;
    for (std::size_t q = 1; q < n; ++q) {
      const auto meet = [&](std::size_t p) {
        const auto dq = static_cast<double>(q), dp = static_cast<double>(p);
        return ((f[q] + dq * dq) - (f[p] + dp * dp)) / (2 * (dq - dp));
      };
      double s = meet(root[last]);
      while (s <= begin[last]) s = meet(root[--last]);
      root[++last] = q;
      begin[last] = s;
      begin[last + 1] = infinity;
    }
    std::size_t k = 0;
    for (std::size_t p = 0; p < n; ++p) {
      while (begin[k + 1] < static_cast<double>(p)) ++k;
      const double d = static_cast<double>(p) - static_cast<double>(root[k]);
      result[p] = d * d + f[root[k]];
    }
    f.swap(result);
  }
};

/// The largest inscribed ball with its centre within `reach` of the start, by exact distances: steps along the axes
/// that halve when none helps. Further away it might become one that was chosen before.
ChildSphere growNearby(const TriangleMesh& mesh, const Vec3& start, double reach) {
  Vec3 centre = start;
  double radius = distanceFrom(mesh, centre), step = 0.5 * reach;
  while (step > 0.02 * reach) {
    bool better = false;
    for (int k = 0; k < 6; ++k) {
      const Vec3 next = centre + (k % 2 ? -step : step) * Vec3::Unit(k / 2);
      // Outside the ball may lie the other side of a wall.
      if (step >= radius || (next - start).norm() > reach) continue;
      const double there = distanceFrom(mesh, next);
      if (there <= radius) continue;
      radius = there;
      centre = next;
      better = true;
    }
    if (!better) step *= 0.5;
  }
  return {centre, radius};
}

/// Greedy choice over the grid.
class Chooser {
 public:
  Chooser(const TriangleMesh& shape, const Grid& cells) : mesh(shape), grid(cells), covered(grid.size(), 0) {
    for (std::size_t n = 0; n < grid.size(); ++n) {
      if (!grid.inside[n]) continue;
      ++insideCells;
      const double radius = radiusOf(n);
      queue.push({4 * pi / 3 * std::pow(radius / grid.edge + 0.87, 3), n});
    }
  }
  std::size_t cellsInside() const { return insideCells; }
  double emptyShare() const { return 1 - static_cast<double>(coveredCells) / static_cast<double>(insideCells); }

  /// Adds the sphere that fills most; false when none fills anything.
  bool chooseNext(std::vector<ChildSphere>& spheres) {
    while (!queue.empty()) {
      const Candidate top = queue.top();
      queue.pop();
      const Vec3 centre = grid.centreOf(grid.cellOf(top.cell));
      double gain = 0;
      grid.visitBall(centre, radiusOf(top.cell), [&](std::size_t n) { gain += grid.inside[n] && !covered[n]; });
      if (gain == 0) continue;
      if (!queue.empty() && gain < queue.top().gain) {
        queue.push({gain, top.cell});
        continue;
      }
      const ChildSphere sphere = growNearby(mesh, centre, grid.edge);
      spheres.push_back(sphere);
      grid.visitBall(sphere.centre, sphere.radius, [&](std::size_t n) {
        coveredCells += grid.inside[n] && !covered[n];
        covered[n] = 1;
      });
      // The cell itself is done with, even where its sphere moved away from it.
      coveredCells += !covered[top.cell];
      covered[top.cell] = 1;
      return true;
    }
    return false;
  }

 private:
  struct Candidate {
    double gain;
    std::size_t cell;
    bool operator<(const Candidate& other) const { return gain != other.gain ? gain < other.gain : cell > other.cell; }
  };
  /// The surface lies about half a cell this side of the nearest outside centre.
  double radiusOf(std::size_t n) const { return std::max(0.5 * grid.edge, grid.distance[n] - 0.5 * grid.edge); }

  const TriangleMesh& mesh;
  const Grid& grid;
  std::vector<std::uint8_t> covered;
  std::size_t insideCells = 0, coveredCells = 0;
  std::priority_queue<Candidate> queue;
};

std::vector<ChildSphere> grown(std::vector<ChildSphere> spheres, double by) {
  for (ChildSphere& child : spheres) child.radius += by;
  return spheres;
}

/// The growth at which the union has this volume: the secant through two volumes, for volume is nearly linear in it.
double findGrowth(const std::vector<ChildSphere>& spheres, double volume, double startVolume, double area) {
  double before = 0, beforeVolume = startVolume, now = (volume - startVolume) / area;
  for (int k = 0; k < 12; ++k) {
    const double here = unionProperties(grown(spheres, now)).principal.volume;
    if (std::abs(here - volume) <= 1e-9 * volume || here == beforeVolume) break;
    const double next = now + (volume - here) * (now - before) / (here - beforeVolume);
    before = now;
    beforeVolume = here;
    now = next;
  }
  return now;
}

void measureFit(const Grid& grid, SphereFit& fit) {
  const MassProperties &mesh = fit.mesh.principal, &clump = fit.clump.principal;
  fit.volumeError = clump.volume / mesh.volume - 1;
  fit.areaError = clump.area / mesh.area - 1;
  fit.inertiaError = (fit.clump.inertia - fit.mesh.inertia).cwiseAbs().maxCoeff() / mesh.inertia.maxCoeff();
  fit.centroidShift = (fit.clump.centroid - fit.mesh.centroid).norm() / std::cbrt(3 * mesh.volume / (4 * pi));
  fit.parts = countParts(fit.spheres);
  std::vector<std::uint8_t> covered(grid.size(), 0);
  for (const ChildSphere& child : fit.spheres)
    grid.visitBall(child.centre, child.radius, [&](std::size_t n) { covered[n] = 1; });
  double differing = 0, inside = 0;
  for (std::size_t n = 0; n < grid.size(); ++n) {
    differing += covered[n] != grid.inside[n];
    inside += grid.inside[n];
  }
  fit.symmetricDifference = differing / inside;
}

}  // namespace

SphereFit fitSpheres(const TriangleMesh& mesh, const SphereFitOptions& options) {
  require(options.count >= 0 && options.mostSpheres > 0 && options.cells >= 8,
          "sphere fit: count must be 0 or more, mostSpheres above 0, cells at least 8");
  require(options.count > 0 || (options.volumeError > 0 && options.volumeError < 1),
          "sphere fit: give a number of spheres, or a volume error between 0 and 1 (it is " +
              std::to_string(options.volumeError) + ")");
  SphereFit fit;
  fit.mesh = solidProperties(mesh.vertices, mesh.triangles);
  const Grid grid(mesh, options.cells);
  Chooser chooser(mesh, grid);
  require(chooser.cellsInside() > 0, "sphere fit: the mesh is thinner than a cell of the grid, a " +
                                         std::to_string(options.cells) + "th of its longest edge: use more cells");

  // Choose; the exact volume decides where an error is asked for, once the grid's estimate is near it.
  const auto emptyOf = [&] { return 1 - unionProperties(fit.spheres).principal.volume / fit.mesh.principal.volume; };
  const int most = options.count > 0 ? options.count : options.mostSpheres;
  double next = options.volumeError + 0.05;
  bool enough = false;
  while (!enough && static_cast<int>(fit.spheres.size()) < most && chooser.chooseNext(fit.spheres)) {
    if (options.count > 0 || chooser.emptyShare() > next) continue;
    fit.empty = emptyOf();
    enough = fit.empty <= options.volumeError;
    next = chooser.emptyShare() * 0.98;
  }
  fit.empty = emptyOf();
  require(options.count > 0 || fit.empty <= options.volumeError,
          "sphere fit: " + std::to_string(fit.spheres.size()) + " spheres leave " + std::to_string(fit.empty) +
              " of the volume empty, more than the " + std::to_string(options.volumeError) +
              " allowed; allow more error, or more spheres and cells");

  if (options.matchVolume) {
    const MassProperties inscribed = unionProperties(fit.spheres).principal;
    fit.growth = findGrowth(fit.spheres, fit.mesh.principal.volume, inscribed.volume, inscribed.area);
    fit.spheres = grown(fit.spheres, fit.growth);
  }
  fit.spheres = withoutHidden(fit.spheres);
  fit.clump = unionProperties(fit.spheres);
  measureFit(grid, fit);
  return fit;
}

}  // namespace granular
