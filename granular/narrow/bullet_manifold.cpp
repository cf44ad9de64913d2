#include "granular/narrow/bullet_manifold.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>

#include "granular/shape/bullet_vectors.h"

namespace granular {
namespace {

/// Bullet's default (gContactBreakingThreshold), which it takes relative to a shape's bounding radius.
constexpr double breakingThreshold = 0.02;

btTransform toBulletTransform(const Frame& frame) {
  const Mat3& R = frame.R;
  return btTransform(btMatrix3x3(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
                     toBullet(frame.x));
}

/// Bullet's normal points from B to A, and its distance is negative inside. m_index0 carries the spot.
btManifoldPoint toBulletPoint(const ManifoldPoint& p, double scale) {
  btManifoldPoint point(toBullet(scale * p.onA), toBullet(scale * p.onB), toBullet(-p.normal), -scale * p.overlap);
  point.m_index0 = p.spot;
  point.m_lifeTime = p.age;
  return point;
}

ManifoldPoint fromBulletPoint(const btManifoldPoint& point, double scale) {
  ManifoldPoint p;
  p.onA = fromBullet(point.m_localPointA) / scale;
  p.onB = fromBullet(point.m_localPointB) / scale;
  p.normal = -fromBullet(point.m_normalWorldOnB);
  p.overlap = -point.m_distance1 / scale;
  p.spot = point.m_index0;
  p.age = point.m_lifeTime;
  return p;
}

/// As btManifoldResult::addContactPoint does: a point near a kept one takes its place and its number.
void addTouch(const ManifoldPoint& found, double scale, btPersistentManifold& bullet, std::int32_t& nextSpot) {
  btManifoldPoint point = toBulletPoint(found, scale);
  const int near = bullet.getCacheEntry(point);
  if (near >= 0) {
    point.m_index0 = bullet.getContactPoint(near).m_index0;
    bullet.replaceContactPoint(point, near);
  } else {
    point.m_index0 = nextSpot++;
    bullet.addManifoldPoint(point);
  }
}

}  // namespace

int refreshManifold(const Shape& a, const Frame& frameA, const Shape& b, const Frame& frameB, const Touch& touch,
                    Manifold& manifold, std::array<ManifoldContact, 4>& out) {
  // Bullet's manifold for the moment: scaled, world axes, origin at A's centre.
  const double scale = 10 / std::min(a.size(), b.size());
  const double threshold = breakingThreshold * scale * std::min(a.boundingRadius(), b.boundingRadius());
  btPersistentManifold bullet(nullptr, nullptr, 0, threshold, threshold);
  for (int k = 0; k < manifold.count; ++k) {
    const btManifoldPoint point = toBulletPoint(manifold.points[static_cast<std::size_t>(k)], scale);
    bullet.addManifoldPoint(point);
    bullet.getContactPoint(k).m_lifeTime = point.m_lifeTime;
  }

  // This step's touch, then every point moved with its bodies, and dropped if it has drifted.
  ManifoldPoint found;
  found.onA = frameA.toBody(touch.onA);
  found.onB = frameB.toBody(touch.onB);
  found.normal = touch.normal;
  found.overlap = touch.overlap;
  addTouch(found, scale, bullet, manifold.nextSpot);
  bullet.refreshContactPoints(toBulletTransform(Frame(frameA.R, Vec3::Zero())),
                              toBulletTransform(Frame(frameB.R, scale * (frameB.x - frameA.x))));

  manifold.count = bullet.getNumContacts();
  for (int k = 0; k < manifold.count; ++k) {
    manifold.points[static_cast<std::size_t>(k)] = fromBulletPoint(bullet.getContactPoint(k), scale);
  }

  // Those that penetrate share the force equally.
  int count = 0;
  for (int k = 0; k < manifold.count; ++k) {
    const ManifoldPoint& p = manifold.points[static_cast<std::size_t>(k)];
    if (!(p.overlap > 0)) continue;
    ManifoldContact& contact = out[static_cast<std::size_t>(count++)];
    const Vec3 middle = 0.5 * (frameA.toWorld(p.onA) + frameB.toWorld(p.onB));
    contact.touch = {p.normal, p.overlap, middle + 0.5 * p.overlap * p.normal, middle - 0.5 * p.overlap * p.normal};
    contact.spot = p.spot;
  }
  std::sort(out.begin(), out.begin() + count,
            [](const ManifoldContact& p, const ManifoldContact& q) { return p.spot < q.spot; });
  for (int k = 0; k < count; ++k) out[static_cast<std::size_t>(k)].share = 1.0 / count;
  return count;
}

}  // namespace granular
