// Bullet alone, as the baselines use it: btDiscreteDynamicsWorld with its persistent manifolds, sequential impulses and
// integrator; nothing falls asleep. Lengths are ours times a scale; masses and times are as they are.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "granular/core/math.h"

namespace granular {

class BulletWorld {
 public:
  /// gravity: m/s^2, downwards; friction and restitution of every contact.
  BulletWorld(double lengthScale, double gravity, double friction, double restitution);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  /// Adds a body at rest; its user index is its number. inertia: in scaled lengths; mass 0: it never moves.
  btRigidBody& addBody(double mass, const btVector3& inertia, std::unique_ptr<btCollisionShape> shape,
                       const Pose& pose);
  void step(double dt) { world.stepSimulation(dt, 0); }

  std::uint64_t countContacts() const;
  /// In m.
  Pose poseOf(std::size_t body) const;
  /// Of the centre of mass, m/s.
  Vec3 velocityOf(std::size_t body) const;

  const double scale;

 private:
  // The world needs the first four; it is declared after them and goes before them.
  btDefaultCollisionConfiguration configuration;
  btDbvtBroadphase broadPhase;
  btSequentialImpulseConstraintSolver solver;

 public:
  btCollisionDispatcher dispatcher{&configuration};
  btDiscreteDynamicsWorld world;
  std::vector<std::unique_ptr<btRigidBody>> bodies;

 private:
  const double frictionOfBody, restitutionOfBody;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
};

}  // namespace granular
