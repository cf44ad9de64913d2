#include "granular/run/bullet_world.h"

#include <cmath>

#include "granular/shape/bullet_vectors.h"

namespace granular {

BulletWorld::BulletWorld(double lengthScale, double gravity, int iterations)
    : scale(lengthScale), dynamics(&dispatcher, &broadPhase, &solver, &configuration) {
  dynamics.setGravity({0, 0, -gravity * scale});
  solverInfo().m_numIterations = iterations;
}

BulletWorld::~BulletWorld() {
  for (const auto& body : bodies) dynamics.removeRigidBody(body.get());
}

void BulletWorld::addBody(const BulletBody& each, const btVector3& inertia, std::unique_ptr<btCollisionShape> shape) {
  btRigidBody::btRigidBodyConstructionInfo info(each.mass, nullptr, shape.get(), inertia);
  info.m_startWorldTransform.setOrigin(toBullet(scale * each.pose.x));
  info.m_startWorldTransform.setRotation({each.pose.q.x(), each.pose.q.y(), each.pose.q.z(), each.pose.q.w()});
  // Bullet multiplies the two bodies' values.
  info.m_friction = std::sqrt(each.friction);
  info.m_restitution = std::sqrt(each.restitution);
  auto body = std::make_unique<btRigidBody>(info);
  body->setActivationState(DISABLE_DEACTIVATION);
  body->setLinearVelocity(toBullet(scale * each.velocity));
  body->setAngularVelocity(toBullet(each.spin));
  body->setUserIndex(static_cast<int>(bodies.size()));
  dynamics.addRigidBody(body.get());
  shapes.push_back(std::move(shape));
  bodies.push_back(std::move(body));
}

Pose BulletWorld::pose(std::size_t k) const {
  const btTransform& at = bodies[k]->getWorldTransform();
  const btQuaternion q = at.getRotation();
  return {fromBullet(at.getOrigin()) / scale, Quat(q.w(), q.x(), q.y(), q.z())};
}

Vec3 BulletWorld::velocity(std::size_t k) const { return fromBullet(bodies[k]->getLinearVelocity()) / scale; }

Vec3 BulletWorld::spin(std::size_t k) const { return fromBullet(bodies[k]->getAngularVelocity()); }

double BulletWorld::kineticEnergy(std::size_t k) const {
  const btRigidBody& body = *bodies[k];
  if (body.getInvMass() == 0) return 0;
  const btMatrix3x3 inertia = body.getInvInertiaTensorWorld().inverse();
  const Vec3 momentum = fromBullet(inertia * body.getAngularVelocity()) / (scale * scale);
  return 0.5 * (velocity(k).squaredNorm() / body.getInvMass() + spin(k).dot(momentum));
}

std::uint64_t BulletWorld::countContacts() const {
  std::uint64_t count = 0;
  visitManifolds([&](const btPersistentManifold& m) { count += static_cast<std::uint64_t>(m.getNumContacts()); });
  return count;
}

}  // namespace granular
