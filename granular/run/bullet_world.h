// A world of Bullet's own, as a baseline: btDiscreteDynamicsWorld with its persistent manifolds, sequential impulses
// and integrator, nothing put to sleep. Positions and velocities come and go in SI units; Bullet sees lengths times
// `scale`, masses and times as they are.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "granular/core/math.h"
#include "granular/shape/shape.h"

namespace granular {

/// What Bullet is told about a body, SI.
struct BulletBody {
  double mass = 0;  ///< kg; 0: fixed
  Pose pose;
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
  double friction = 0, restitution = 0;  ///< of a contact between two bodies with the same
};

class BulletWorld {
 public:
  /// gravity: along -z, m/s^2; iterations: of the solver.
  BulletWorld(double scale, double gravity, int iterations);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  /// Adds a body of a shape in scaled lengths with this inertia (scaled too) and the next user index.
  void addBody(const BulletBody& body, const btVector3& inertia, std::unique_ptr<btCollisionShape> shape);
  void step(double dt) { dynamics.stepSimulation(dt, 0); }

  std::size_t size() const { return bodies.size(); }
  Pose pose(std::size_t k) const;
  Vec3 velocity(std::size_t k) const;
  Vec3 spin(std::size_t k) const;
  double kineticEnergy(std::size_t k) const;
  std::uint64_t countContacts() const;
  /// Calls visit(manifold) for every pair of bodies near each other.
  template <class Visitor>
  void visitManifolds(Visitor&& visit) const {
    for (int k = 0; k < dispatcher.getNumManifolds(); ++k) visit(*dispatcher.getManifoldByIndexInternal(k));
  }
  btContactSolverInfo& solverInfo() { return dynamics.getSolverInfo(); }

 private:
  const double scale;
  btDefaultCollisionConfiguration configuration;
  // Bullet hands out manifolds through a reference that is not const, and changes none of them.
  mutable btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadPhase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld dynamics;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
};

}  // namespace granular
