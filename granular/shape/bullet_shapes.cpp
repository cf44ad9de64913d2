// Bullet's view of every shape, with no margin at all: Bullet's own sphere is a point with a margin and its cone is
// centred at half height, so round shapes enter through one class that answers with the shape's exact support point.
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>

#include "granular/shape/bullet_vectors.h"
#include "granular/shape/clump.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"

namespace granular {

namespace {

/// A convex shape of Bullet's whose support function is a functor Vec3(const Vec3&), about the origin.
template <class Support>
class ExactShape final : public btConvexInternalShape {
 public:
  ExactShape(Support function, const MassProperties& properties)
      : supportPoint(std::move(function)), inertiaPerMass(toBullet(properties.inertia / properties.volume)) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    m_collisionMargin = 0;
  }

  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& d) const override {
    return toBullet(supportPoint(fromBullet(d * m_localScaling))) * m_localScaling;
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* points,
                                                         int count) const override {
    for (int k = 0; k < count; ++k) points[k] = localGetSupportingVertexWithoutMargin(directions[k]);
  }
  void calculateLocalInertia(btScalar mass, btVector3& inertia) const override { inertia = mass * inertiaPerMass; }
  const char* getName() const override { return "granular"; }

 private:
  Support supportPoint;
  btVector3 inertiaPerMass;
};

template <class Support>
std::unique_ptr<btConvexShape> makeExactShape(const Shape& shape, double scale, Support support) {
  MassProperties scaled = shape.massProperties();
  scaled.inertia *= scale * scale;
  return std::make_unique<ExactShape<Support>>(std::move(support), scaled);
}

}  // namespace

std::unique_ptr<btConvexShape> Sphere::makeBulletShape(double scale) const {
  return makeExactShape(*this, scale, [radius = r * scale](const Vec3& d) { return sphereSupport(radius, d); });
}

std::unique_ptr<btConvexShape> Ellipsoid::makeBulletShape(double scale) const {
  return makeExactShape(*this, scale,
                        [scaled = Vec3(axes * scale)](const Vec3& d) { return ellipsoidSupport(scaled, d); });
}

std::unique_ptr<btConvexShape> Cylinder::makeBulletShape(double scale) const {
  return makeExactShape(*this, scale, [radius = r * scale, halfHeight = half * scale](const Vec3& d) {
    return cylinderSupport(radius, halfHeight, d);
  });
}

std::unique_ptr<btConvexShape> Cone::makeBulletShape(double scale) const {
  return makeExactShape(
      *this, scale, [radius = r * scale, height = h * scale](const Vec3& d) { return coneSupport(radius, height, d); });
}

std::unique_ptr<btConvexShape> Polyhedron::makeBulletShape(double scale) const {
  if (kind() == ShapeKind::cuboid) {
    const btVector3 half = toBullet(topology.vertices.back() * scale);
    auto box = std::make_unique<btBoxShape>(half);
    box->setMargin(0);
    // taking the default margin off and on again rounded the lengths
    box->setImplicitShapeDimensions(half);
    return box;
  }
  auto hull = std::make_unique<btConvexHullShape>();
  hull->setMargin(0);
  for (const Vec3& v : topology.vertices) hull->addPoint(toBullet(v * scale), false);
  hull->recalcLocalAabb();
  return hull;
}

std::unique_ptr<btConvexShape> Clump::makeBulletShape(double scale) const {
  return makeExactShape(*this, scale, [scaled = Clump(*this, scale).children()](const Vec3& d) {
    const ChildSphere& child = highestChild(scaled, d);
    return Vec3(child.centre + sphereSupport(child.radius, d));
  });
}

}  // namespace granular
