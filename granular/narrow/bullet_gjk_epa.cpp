#include "granular/narrow/bullet_gjk_epa.h"

#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include "granular/shape/bullet_vectors.h"

namespace granular {
namespace {

/// A shape of ours, scaled, as Bullet's solver sees it: its support function is all that is asked for.
class ScaledShape final : public btConvexInternalShape {
 public:
  ScaledShape(const Shape& ours, double factor) : shape(ours), scale(factor) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    m_collisionMargin = 0;
  }

  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override {
    const Vec3 d = fromBullet(direction);
    const double length2 = d.squaredNorm();
    return toBullet(scale * shape.support(length2 > 0 ? d : Vec3::UnitX()));
  }
  btVector3 localGetSupportingVertex(const btVector3& direction) const override {
    return localGetSupportingVertexWithoutMargin(direction);
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* out,
                                                         int count) const override {
    for (int k = 0; k < count; ++k) out[k] = localGetSupportingVertexWithoutMargin(directions[k]);
  }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
  const char* getName() const override { return "scaled shape"; }

 private:
  const Shape& shape;
  double scale;
};

}  // namespace

PenetrationAnswer askBullet(const Difference& c, const Vec3& guess) {
  // Bullet's absolute tolerances suit bodies of some ten units; the smaller one of the pair gets that size.
  const double scale = 10 / c.size();
  const ScaledShape a(c.shapeA(), scale), b(c.shapeB(), scale);
  btTransform frameB;
  const Mat3& R = c.frame().R;
  frameB.setBasis(btMatrix3x3(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)));
  frameB.setOrigin(toBullet(scale * c.frame().x));

  btGjkEpaSolver2::sResults results;
  PenetrationAnswer answer;
  answer.penetrating =
      btGjkEpaSolver2::Penetration(&a, btTransform::getIdentity(), &b, frameB, toBullet(guess), results, false);
  if (!answer.penetrating) return answer;

  // The distance between its witness points is the depth; its sign conventions differ, so that the normal is turned to
  // point from A to B by the side on which the depth is the smaller.
  answer.overlap = (results.witnesses[0] - results.witnesses[1]).length() / scale;
  const Vec3 n = fromBullet(results.normal);
  const double length = n.norm();
  if (!(length > 0) || !n.allFinite()) {
    answer.penetrating = false;
    return answer;
  }
  answer.normal = n / length;
  return answer;
}

}  // namespace granular
