#include "granular/shape/clump.h"

#include <algorithm>

#include "granular/core/errors.h"
#include "granular/core/tolerances.h"
#include "granular/shape/revolution.h"

namespace granular {
namespace {

void requireSpheres(std::span<const ChildSphere> given) {
  require(!given.empty(), "clump: no spheres given; at least one is needed");
  for (std::size_t k = 0; k < given.size(); ++k) {
    const std::string name = "of sphere " + std::to_string(k + 1);
    requireLength("clump", "radius " + name, given[k].radius);
    require(given[k].centre.allFinite(), "clump: the centre " + name + " is not finite");
  }
}

}  // namespace

Clump::Clump(std::span<const ChildSphere> given, Frame* toBody) : Shape(ShapeKind::clump) {
  requireSpheres(given);
  const SolidProperties solid = unionProperties(given);
  const Frame frame = solid.frame();
  if (toBody) *toBody = frame;
  spheres = withoutHidden(given);
  for (ChildSphere& child : spheres) child.centre = frame.toBody(child.centre);
  measured = solid.principal;
  finish(measured);
}

Clump::Clump(std::span<const ChildSphere> given, const MassProperties& prescribed) : Shape(ShapeKind::clump) {
  requireSpheres(given);
  require(std::isfinite(prescribed.volume) && prescribed.volume > 0 && prescribed.inertia.allFinite() &&
              prescribed.inertia.minCoeff() > 0 && prescribed.meanSquareRadius > 0,
          "clump: prescribed volume, principal moments and mean squared radius must be finite and above 0");
  measured = unionProperties(given).principal;
  spheres = withoutHidden(given);
  finish(prescribed);
}

Clump::Clump(const Clump& source, double factor)
    : Shape(ShapeKind::clump), spheres(source.spheres), measured(source.measured) {
  for (ChildSphere& child : spheres) {
    child.centre *= factor;
    child.radius *= factor;
  }
  const double square = factor * factor;
  measured.volume *= square * factor;
  measured.area *= square;
  measured.inertia *= square * square * factor;
  measured.meanSquareRadius *= square;
  makeChildren();
  setScaledMeasures(source, factor);
}

void Clump::makeChildren() {
  for (const ChildSphere& child : spheres) shapes.push_back(std::make_unique<Sphere>(child.radius));
  bounding = SphereTree(spheres);
  partCount = countParts(spheres);
}

void Clump::finish(const MassProperties& properties) {
  makeChildren();
  double outer = 0, inner = 0, length = 0;
  for (const ChildSphere& child : spheres) {
    outer = std::max(outer, child.centre.norm() + child.radius);
    inner = std::max(inner, child.radius - child.centre.norm());
    for (const ChildSphere& other : spheres)
      length = std::max(length, (child.centre - other.centre).norm() + child.radius + other.radius);
  }
  setMeasures(properties, outer, inner, length, distinctAxis(properties.inertia, false));
}

double Clump::smallestRadius() const {
  const auto smaller = [](const ChildSphere& a, const ChildSphere& b) { return a.radius < b.radius; };
  return std::min_element(spheres.begin(), spheres.end(), smaller)->radius;
}

const ChildSphere& highestChild(std::span<const ChildSphere> spheres, const Vec3& d) {
  const double length = d.norm();
  const ChildSphere* best = &spheres[0];
  double highest = -infinity;
  for (const ChildSphere& child : spheres) {
    const double height = d.dot(child.centre) + length * child.radius;
    if (height > highest) {
      highest = height;
      best = &child;
    }
  }
  return *best;
}

Vec3 Clump::support(const Vec3& d) const {
  const ChildSphere& child = highestChild(spheres, d);
  return child.centre + sphereSupport(child.radius, d);
}

void Clump::supportFeature(const Vec3& d, double, Feature& out) const {
  out.clear();
  out.push(support(d));
}

Vec3 Clump::supportFace(const Vec3& d, double, Feature& out) const {
  out.clear();
  out.push(support(d));
  return d;
}

bool Clump::contains(const Vec3& p) const {
  return std::any_of(spheres.begin(), spheres.end(), [&](const ChildSphere& child) {
    return (p - child.centre).norm() <= child.radius * (1 + tolerance::onSurface);
  });
}

namespace {

void append(const TriangleMesh& part, TriangleMesh& whole) {
  const auto first = static_cast<int>(whole.vertices.size());
  whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& t : part.triangles) whole.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

/// The surface of one of the spheres. A chord of a circle of radius r in n segments lies r (pi/n)^2/2 within it.
TriangleMesh sphereMesh(const ChildSphere& child, double largestRadius, int resolution) {
  constexpr int fewest = 6;
  const int segments = static_cast<int>(std::ceil(resolution * std::sqrt(child.radius / largestRadius)));
  TriangleMesh mesh = ellipsoidMesh(Vec3::Constant(child.radius), std::max(segments, fewest));
  for (Vec3& v : mesh.vertices) v += child.centre;
  return mesh;
}

/// Leaves out triangles that lie in the sphere: it is convex, so that their corners tell.
void dropWithin(const ChildSphere& sphere, TriangleMesh& mesh) {
  const auto isWithin = [&](int vertex) {
    return (mesh.vertices[static_cast<std::size_t>(vertex)] - sphere.centre).squaredNorm() <
           sphere.radius * sphere.radius;
  };
  std::erase_if(mesh.triangles, [&](const auto& t) { return isWithin(t[0]) && isWithin(t[1]) && isWithin(t[2]); });
}

void dropUnused(TriangleMesh& mesh) {
  std::vector<int> place(mesh.vertices.size(), -1);
  std::vector<Vec3> used;
  for (auto& t : mesh.triangles) {
    for (int& vertex : t) {
      int& now = place[static_cast<std::size_t>(vertex)];
      if (now < 0) {
        now = static_cast<int>(used.size());
        used.push_back(mesh.vertices[static_cast<std::size_t>(vertex)]);
      }
      vertex = now;
    }
  }
  mesh.vertices.swap(used);
}

double largestRadius(std::span<const ChildSphere> spheres) {
  double largest = 0;
  for (const ChildSphere& child : spheres) largest = std::max(largest, child.radius);
  return largest;
}

}  // namespace

TriangleMesh Clump::surface(int resolution) const {
  const double largest = largestRadius(spheres);
  TriangleMesh all;
  for (const ChildSphere& child : spheres) append(sphereMesh(child, largest, resolution), all);
  return all;
}

TriangleMesh Clump::outerSurface(int resolution) const {
  const double largest = largestRadius(spheres);
  TriangleMesh all;
  for (const ChildSphere& child : spheres) {
    TriangleMesh mesh = sphereMesh(child, largest, resolution);
    for (const ChildSphere& other : spheres) {
      const double reach = child.radius + other.radius;
      if (&other != &child && (other.centre - child.centre).squaredNorm() < reach * reach) dropWithin(other, mesh);
    }
    dropUnused(mesh);
    append(mesh, all);
  }
  return all;
}

std::string Clump::describe() const {
  const Aabb box = bounds(Frame{});
  const Vec3 extent = box.hi - box.lo;
  std::string text = "clump of " + std::to_string(spheres.size()) + (spheres.size() == 1 ? " sphere, " : " spheres, ") +
                     describeLengths({extent.x(), extent.y(), extent.z()});
  if (partCount > 1) text += ", in " + std::to_string(partCount) + " parts that do not touch";
  return text;
}

Aabb Clump::bounds(const Frame& frame) const {
  Aabb box;
  for (const ChildSphere& child : spheres) {
    const Vec3 centre = frame.toWorld(child.centre);
    box.lo = box.lo.cwiseMin((centre.array() - child.radius).matrix());
    box.hi = box.hi.cwiseMax((centre.array() + child.radius).matrix());
  }
  return box;
}

}  // namespace granular
