#include "granular/shape/chords.h"

#include <algorithm>

#include "granular/shape/clump.h"
#include "granular/shape/ellipsoid.h"

namespace granular {
namespace {

/// |centre + t ez - (x, y)| in units of the semi-axes is 1: a quadratic equation in t.
void cutEllipsoid(const Vec3& semi, const Frame& frame, double x, double y, std::vector<Chord>& out) {
  const Vec3 inverse = semi.cwiseInverse();
  const Vec3 p = inverse.cwiseProduct(frame.toBody({x, y, frame.x.z()}));
  const Vec3 d = inverse.cwiseProduct(frame.unrotate(Vec3::UnitZ()));
  const double a = d.squaredNorm(), b = p.dot(d), root = b * b - a * (p.squaredNorm() - 1);
  if (!(root > 0)) return;
  const double half = std::sqrt(root) / a, middle = frame.x.z() - b / a;
  out.push_back({middle - half, middle + half});
}

/// Ascending stretches that may overlap, into stretches apart.
void unite(std::vector<Chord>& chords) {
  std::sort(chords.begin(), chords.end(), [](const Chord& a, const Chord& b) { return a.low < b.low; });
  std::size_t last = 0;
  for (std::size_t k = 1; k < chords.size(); ++k) {
    if (chords[k].low <= chords[last].high) {
      chords[last].high = std::max(chords[last].high, chords[k].high);
    } else {
      chords[++last] = chords[k];
    }
  }
  if (!chords.empty()) chords.resize(last + 1);
}

/// Height at which the line (x, y) meets a triangle of the surface, if it does. A shared edge counts for one side.
bool meet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec2& p, double& z) {
  const auto side = [&](const Vec3& from, const Vec3& to) {
    const bool flipped = to.x() < from.x() || (to.x() == from.x() && to.y() < from.y());
    const Vec3 &s = flipped ? to : from, &t = flipped ? from : to;
    const double cross = (t.x() - s.x()) * (p.y() - s.y()) - (t.y() - s.y()) * (p.x() - s.x());
    return (cross >= 0) != flipped;
  };
  const bool first = side(a, b);
  if (side(b, c) != first || side(c, a) != first) return false;
  const Vec3 n = (b - a).cross(c - a);
  if (n.z() == 0) return false;
  z = a.z() - (n.x() * (p.x() - a.x()) + n.y() * (p.y() - a.y())) / n.z();
  return true;
}

}  // namespace

const TriangleMesh& ChordFinder::surfaceOf(const Shape& shape) {
  for (const auto& [known, mesh] : surfaces)
    if (known == &shape) return mesh;
  return surfaces.emplace_back(&shape, shape.surface(segments)).second;
}

void ChordFinder::find(const Shape& shape, const Frame& frame, double x, double y, std::vector<Chord>& out) {
  out.clear();
  if ((frame.x.head<2>() - Vec2(x, y)).norm() > shape.boundingRadius()) return;
  if (const Clump* clump = asClump(shape)) {
    for (const ChildSphere& child : clump->children()) {
      const Vec3 c = frame.toWorld(child.centre);
      const double square = child.radius * child.radius - (c.head<2>() - Vec2(x, y)).squaredNorm();
      if (square > 0) out.push_back({c.z() - std::sqrt(square), c.z() + std::sqrt(square)});
    }
    return unite(out);
  }
  if (shape.kind() == ShapeKind::sphere) return cutEllipsoid(Vec3::Constant(shape.size()), frame, x, y, out);
  if (shape.kind() == ShapeKind::ellipsoid) {
    return cutEllipsoid(static_cast<const Ellipsoid&>(shape).semiAxes(), frame, x, y, out);
  }
  // Convex: from the lowest to the highest meeting with its surface.
  const TriangleMesh& mesh = surfaceOf(shape);
  Chord chord{infinity, -infinity};
  for (const auto& [i, j, k] : mesh.triangles) {
    double z = 0;
    const auto corner = [&](int index) { return frame.toWorld(mesh.vertices[static_cast<std::size_t>(index)]); };
    if (!meet(corner(i), corner(j), corner(k), {x, y}, z)) continue;
    chord.low = std::min(chord.low, z);
    chord.high = std::max(chord.high, z);
  }
  if (chord.low < chord.high) out.push_back(chord);
}

double ChordFinder::sectionArea(const Shape& shape, const Frame& frame, double y, int samples) {
  // x = middle + half sin t: chords that fall to zero as a root at the ends become smooth in t.
  const Aabb box = shape.bounds(frame);
  const double middle = 0.5 * (box.lo.x() + box.hi.x()), half = 0.5 * (box.hi.x() - box.lo.x());
  std::vector<Chord> chords;
  double area = 0;
  for (int k = 0; k < samples; ++k) {
    const double t = pi * ((k + 0.5) / samples - 0.5);
    find(shape, frame, middle + half * std::sin(t), y, chords);
    for (const Chord& chord : chords) area += (chord.high - chord.low) * half * std::cos(t) * pi / samples;
  }
  return area;
}

}  // namespace granular
