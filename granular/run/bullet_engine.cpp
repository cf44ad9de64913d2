// Bullet alone as an engine of the comparison: btDiscreteDynamicsWorld as it comes, with its persistent manifolds,
// sequential impulses and integrator, nothing put to sleep.
//
// Bullet's tolerances are absolute lengths and speeds, meant for things of a metre. Here each is that share of the
// scene's unit: margins .04 a (polyhedra are shrunk by theirs, so that the outside is the shape), split impulses from a
// depth of .04 a, no restitution below .2 m/s at 1 m, in proportion to sqrt(a) elsewhere, and never below the speed
// that a step of free fall gives. The contact breaking threshold is relative by default. What can't be set stays:
// tolerances inside its GJK and box kernels.
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "granular/core/errors.h"
#include "granular/run/comparison_engine.h"
#include "granular/shape/bullet_vectors.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

/// The corners of a polyhedron whose faces have all moved inwards by `depth`, as long as it keeps its topology.
std::vector<Vec3> shrinkPolyhedron(const PolyhedronTables& tables, double depth) {
  std::vector<Vec3> corners;
  for (std::size_t v = 0; v < tables.vertices.size(); ++v) {
    // The point nearest to all faces that meet there: their common point where they are three.
    Mat3 sum = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (const PolyhedronTables::Spoke& spoke : tables.spokesOf(static_cast<std::int32_t>(v))) {
      const auto& [n, offset] = tables.faces[static_cast<std::size_t>(spoke.face)];
      sum += n * n.transpose();
      right += (offset - depth) * n;
    }
    corners.push_back(sum.inverse() * right);
  }
  return corners;
}

/// Bullet's shape for a cuboid or a polyhedron, all lengths times scale; margin in scaled lengths.
std::unique_ptr<btCollisionShape> makeShape(const Shape& shape, double scale, double margin) {
  if (shape.kind() == ShapeKind::cuboid) {
    auto box = std::make_unique<btBoxShape>(toBullet(scale * static_cast<const Cuboid&>(shape).halfLengths()));
    box->setMargin(margin);
    return box;
  }
  require(shape.kind() == ShapeKind::polyhedron, shape.describe() + ": Bullet gets cuboids and polyhedra only");
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& corner : shrinkPolyhedron(static_cast<const Polyhedron&>(shape).tables(), margin / scale)) {
    hull->addPoint(toBullet(scale * corner), false);
  }
  hull->recalcLocalAabb();
  hull->setMargin(margin);
  return hull;
}

/// Bullet's world with the scene in it. Lengths times `scale`; masses and times as they are.
class BulletScene {
 public:
  BulletScene(const SceneSetup& chosen, const EngineSettings& settings)
      : setup(chosen),
        scale(settings.scaled ? 1 / chosen.unit : 1),
        world(&dispatcher, &broadPhase, &solver, &configuration) {
    const double unit = scale * setup.unit;
    world.setGravity({0, 0, -setup.gravity * scale});
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_numIterations = settings.iterations;
    info.m_splitImpulsePenetrationThreshold *= unit;
    // 1.22 g dt is what .2 m/s is at steps of 1/60 s: below that a body at rest would bounce.
    info.m_restitutionVelocityThreshold =
        std::max(0.2 * std::sqrt(setup.unit), 1.22 * setup.gravity * settings.step) * scale;

    for (const ScenePlane& plane : setup.planes) {
      auto shape = std::make_unique<btStaticPlaneShape>(toBullet(plane.normal), scale * plane.normal.dot(plane.point));
      shape->setMargin(margin * unit);
      addBody(0, btVector3(0, 0, 0), std::move(shape), SceneBody{});
    }
    planes = bodies.size();
    for (std::size_t k = 0; k < setup.bodies.size(); ++k) {
      const SceneBody& each = setup.bodies[k];
      const double mass = each.fixed ? 0 : setup.mass(k);
      // Of the true solid: Bullet's own would be that of the bounds for polyhedra.
      const Vec3 inertia = scale * scale * setup.density * each.shape->massProperties().inertia;
      addBody(mass, each.fixed ? btVector3(0, 0, 0) : toBullet(inertia), makeShape(*each.shape, scale, margin * unit),
              each);
    }
  }
  ~BulletScene() {
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }
  BulletScene(const BulletScene&) = delete;
  BulletScene& operator=(const BulletScene&) = delete;

  void step(double dt) { world.stepSimulation(dt, 0); }

  std::uint64_t countContacts() {
    std::uint64_t count = 0;
    for (int k = 0; k < dispatcher.getNumManifolds(); ++k) {
      count += static_cast<std::uint64_t>(dispatcher.getManifoldByIndexInternal(k)->getNumContacts());
    }
    return count;
  }

  /// Adds a snapshot; false, and none added, if it is not finite.
  bool record(double time, Recording& recording) const {
    Snapshot now;
    now.time = time;
    for (std::size_t k = planes; k < bodies.size(); ++k) {
      const btTransform& at = bodies[k]->getWorldTransform();
      const btQuaternion q = at.getRotation();
      BodyMotion motion;
      motion.pose = {fromBullet(at.getOrigin()) / scale, Quat(q.w(), q.x(), q.y(), q.z())};
      motion.velocity = fromBullet(bodies[k]->getLinearVelocity()) / scale;
      motion.spin = fromBullet(bodies[k]->getAngularVelocity());
      if (!motion.pose.x.allFinite() || !motion.pose.q.coeffs().allFinite() || !motion.spin.allFinite()) return false;
      now.bodies.push_back(motion);
    }
    recording.snapshots.push_back(std::move(now));
    return true;
  }

 private:
  static constexpr double margin = 0.04;  ///< Bullet's own at 1 m, over a

  void addBody(double mass, const btVector3& inertia, std::unique_ptr<btCollisionShape> shape, const SceneBody& each) {
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
    info.m_startWorldTransform.setOrigin(toBullet(scale * each.pose.x));
    info.m_startWorldTransform.setRotation({each.pose.q.x(), each.pose.q.y(), each.pose.q.z(), each.pose.q.w()});
    // Bullet multiplies the two bodies' values.
    info.m_friction = std::sqrt(setup.friction);
    info.m_restitution = std::sqrt(setup.restitution);
    auto body = std::make_unique<btRigidBody>(info);
    body->setActivationState(DISABLE_DEACTIVATION);
    body->setLinearVelocity(toBullet(scale * each.velocity));
    body->setAngularVelocity(toBullet(each.spin));
    world.addRigidBody(body.get());
    shapes.push_back(std::move(shape));
    bodies.push_back(std::move(body));
  }

  const SceneSetup& setup;
  const double scale;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadPhase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;  ///< planes first
  std::size_t planes = 0;
};

}  // namespace

EngineRun runBulletScene(const SceneSetup& setup, const EngineSettings& settings) {
  BulletScene scene(setup, settings);
  EngineRun run;
  run.step = settings.step;
  const auto steps = static_cast<std::int64_t>(std::ceil(setup.duration / run.step - 1e-9));
  const std::int64_t perSample = std::max<std::int64_t>(1, std::llround(setup.sampleEvery / run.step));
  scene.record(0, run.recording);

  const std::clock_t began = std::clock();
  for (std::int64_t k = 1; k <= steps && run.recording.finite; ++k) {
    scene.step(run.step);
    run.contacts += scene.countContacts();
    run.steps = k;
    run.simulated = static_cast<double>(k) * run.step;
    if (k % perSample == 0 || k == steps) run.recording.finite = scene.record(run.simulated, run.recording);
  }
  run.processorTime = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
  return run;
}

}  // namespace granular
