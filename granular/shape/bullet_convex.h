// Any convex shape of Bullet's, a user's own subclass included, known by its support function alone:
// localGetSupportingVertexWithoutMargin. Its margin is never used (set a btBoxShape's or btCylinderShape's to 0 first,
// which gives them their full size; a btSphereShape is all margin: use Sphere). Everything else is found by asking that
// function: mass properties from ever finer inscribed polytopes, extrapolated, with the error they leave.
#pragma once

#include <memory>
#include <vector>

#include "granular/shape/shape.h"

namespace granular {

struct SupportPolytope;

class BulletConvex final : public Shape {
 public:
  /// The shape multiplied by metresPerUnit, moved to its centre of mass and turned to its principal axes; toBody
  /// receives the frame of the body in the shape's own axes (in m): shape point * metresPerUnit = toBody->toWorld(body
  /// point). The shape must stay as it is, and its support function must be callable from several threads at once.
  /// Throws InputError for a null shape, a scale that is not finite and above 0, and a support function that is not
  /// finite or gives a body without volume.
  explicit BulletConvex(std::shared_ptr<const btConvexShape> shape, double metresPerUnit = 1, Frame* toBody = nullptr);
  /// The source multiplied by factor (> 0); the Bullet shape is shared.
  BulletConvex(const BulletConvex& source, double factor);

  const btConvexShape& bulletShape() const { return *shape; }
  /// Metres per unit of the Bullet shape.
  double unit() const { return metresPerUnit; }
  /// Estimated largest relative error of volume, area, inertia and <r²>: how much the extrapolation still moved from
  /// the last but one refinement to the last. Of the order of rounding for bodies with flat faces only.
  double massError() const { return relativeError; }

  Vec3 support(const Vec3& d) const override;
  /// Found by asking for support along directions tilted from d, so that a flat face shows its corners.
  void supportFeature(const Vec3& d, double slab, Feature& out) const override;
  /// Flat faces are those found in the refinement; of a round one up to Feature::capacity points on its rim.
  Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const override;
  bool contains(const Vec3& p) const override;
  /// The inscribed polytope of the first refinement, whatever the resolution.
  TriangleMesh surface(int resolution) const override;
  std::unique_ptr<btConvexShape> makeBulletShape(double scale) const override;
  std::string describe() const override;

 private:
  struct FlatFace {
    Vec3 normal;
    std::vector<Vec3> corners;
  };
  void findFlatFaces(const SupportPolytope& polytope, double extent);
  void measure(const MassProperties& properties);

  std::shared_ptr<const btConvexShape> shape;
  double metresPerUnit;
  Frame frame;  ///< body to shape axes, m
  double relativeError = 0;
  TriangleMesh inscribed;
  std::vector<FlatFace> flatFaces;
};

}  // namespace granular
