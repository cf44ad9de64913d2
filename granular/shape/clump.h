// A clump: one rigid body of several spheres, its children (Markauskas et al. 2010, section 2). Children overlap as
// they like and never touch each other. A clump need not be convex: Shape's support function and features are those of
// its convex hull, which serve bounds and insertion; contacts are made child by child (narrow/clump_pair.h).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "granular/shape/sphere.h"
#include "granular/shape/sphere_tree.h"
#include "granular/shape/sphere_union.h"

namespace granular {

class Clump final : public Shape {
 public:
  /// The union of the spheres, each point of it counted once, moved to its centre of mass and turned to its principal
  /// axes; toBody receives the frame of the body in the input coordinates: input point = toBody->toWorld(body point).
  /// Spheres inside others are left out. Spheres that don't hang together are allowed (parts()). Throws InputError for
  /// no spheres, a centre that is not finite, or a radius that is not finite and above 0.
  explicit Clump(std::span<const ChildSphere> spheres, Frame* toBody = nullptr);

  /// The spheres as given in body axes, with the mass properties of what they stand for: a smooth ellipsoid, a mesh.
  Clump(std::span<const ChildSphere> spheres, const MassProperties& prescribed);

  /// The source multiplied by factor (> 0), in the same body axes.
  Clump(const Clump& source, double factor);

  /// Centres in body axes, m.
  const std::vector<ChildSphere>& children() const { return spheres; }
  /// A child as a shape about its own centre.
  const Sphere& childShape(std::int32_t child) const { return *shapes[static_cast<std::size_t>(child)]; }
  const SphereTree& tree() const { return bounding; }
  /// Of the union, whatever mass properties were prescribed.
  const MassProperties& unionMeasures() const { return measured; }
  /// How many parts don't hang together: 1 for a clump in one piece.
  int parts() const { return partCount; }
  double smallestRadius() const;

  Vec3 support(const Vec3& d) const override;
  void supportFeature(const Vec3& d, double slab, Feature& out) const override;
  Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const override;
  /// Of the union.
  bool contains(const Vec3& p) const override;
  /// The surfaces of all children, each closed; where children overlap they run through each other. resolution: of the
  /// largest child; smaller ones have fewer segments, that lie as far from their spheres.
  TriangleMesh surface(int resolution) const override;
  /// The same without the triangles that lie in another child as a whole: what is seen, for pictures. Not closed.
  TriangleMesh outerSurface(int resolution) const;
  /// The convex hull of the children. For the children themselves: makeBulletCompound (shape/bullet_clump.h).
  std::unique_ptr<btConvexShape> makeBulletShape(double scale) const override;
  std::string describe() const override;
  Aabb bounds(const Frame& frame) const override;

 private:
  void finish(const MassProperties& properties);
  void makeChildren();

  std::vector<ChildSphere> spheres;
  std::vector<std::unique_ptr<const Sphere>> shapes;
  SphereTree bounding;
  MassProperties measured;
  int partCount = 1;
};

/// The sphere that reaches furthest along d (any length > 0); the first of equals.
const ChildSphere& highestChild(std::span<const ChildSphere> spheres, const Vec3& d);

/// The clump that a shape is, or null.
inline const Clump* asClump(const Shape& shape) {
  return shape.kind() == ShapeKind::clump ? static_cast<const Clump*>(&shape) : nullptr;
}

/// A child of a placed clump as a placed shape; a shape that is no clump (child < 0) as it is.
struct PlacedChild {
  const Shape* shape;
  Frame frame;
};
inline PlacedChild placeChild(const Shape& shape, const Frame& frame, std::int32_t child) {
  if (child < 0) return {&shape, frame};
  const auto& clump = static_cast<const Clump&>(shape);
  return {&clump.childShape(child),
          Frame(frame.R, frame.toWorld(clump.children()[static_cast<std::size_t>(child)].centre))};
}

/// A child of a placed clump, or a placed sphere (child < 0), as a ball.
struct PlacedBall {
  Vec3 centre;
  double radius;
};
inline PlacedBall placeBall(const Shape& shape, const Frame& frame, std::int32_t child) {
  if (child < 0) return {frame.x, shape.boundingRadius()};
  const ChildSphere& sphere = static_cast<const Clump&>(shape).children()[static_cast<std::size_t>(child)];
  return {frame.toWorld(sphere.centre), sphere.radius};
}

}  // namespace granular
