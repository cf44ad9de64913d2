// Bullet alone as an engine of the comparison.
//
// Bullet's tolerances are absolute lengths and speeds, meant for things of a metre. Here each is that share of the
// scene's unit: margins .04 a (polyhedra are shrunk by theirs, so that the outside is the shape), split impulses from a
// depth of .04 a, no restitution below .2 m/s at 1 m, in proportion to sqrt(a) elsewhere, and never below the speed
// that a step of free fall gives. The contact breaking threshold is relative by default. What can't be set stays:
// tolerances inside its GJK and box kernels.
#include <algorithm>
#include <cmath>
#include <ctime>

#include "granular/core/errors.h"
#include "granular/run/bullet_world.h"
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

/// The scene in Bullet's world: planes first, then its bodies.
class BulletScene {
 public:
  BulletScene(const SceneSetup& chosen, const EngineSettings& settings)
      : setup(chosen), scale(settings.scaled ? 1 / chosen.unit : 1), world(scale, chosen.gravity, settings.iterations) {
    const double unit = scale * setup.unit;
    btContactSolverInfo& info = world.solverInfo();
    info.m_splitImpulsePenetrationThreshold *= unit;
    // 1.22 g dt is what .2 m/s is at steps of 1/60 s: below that a body at rest would bounce.
    info.m_restitutionVelocityThreshold =
        std::max(0.2 * std::sqrt(setup.unit), 1.22 * setup.gravity * settings.step) * scale;

    for (const ScenePlane& plane : setup.planes) {
      auto shape = std::make_unique<btStaticPlaneShape>(toBullet(plane.normal), scale * plane.normal.dot(plane.point));
      shape->setMargin(margin * unit);
      addBody(0, btVector3(0, 0, 0), std::move(shape), SceneBody{});
    }
    planes = world.size();
    for (std::size_t k = 0; k < setup.bodies.size(); ++k) {
      const SceneBody& each = setup.bodies[k];
      const double mass = each.fixed ? 0 : setup.mass(k);
      // Of the true solid: Bullet's own would be that of the bounds for polyhedra.
      const Vec3 inertia = scale * scale * setup.density * each.shape->massProperties().inertia;
      addBody(mass, each.fixed ? btVector3(0, 0, 0) : toBullet(inertia), makeShape(*each.shape, scale, margin * unit),
              each);
    }
  }

  void step(double dt) { world.step(dt); }
  std::uint64_t countContacts() const { return world.countContacts(); }

  /// Adds a snapshot; false, and none added, if it is not finite.
  bool record(double time, Recording& recording) const {
    Snapshot now;
    now.time = time;
    for (std::size_t k = planes; k < world.size(); ++k) {
      BodyMotion motion;
      motion.pose = world.pose(k);
      motion.velocity = world.velocity(k);
      motion.spin = world.spin(k);
      if (!motion.pose.x.allFinite() || !motion.pose.q.coeffs().allFinite() || !motion.spin.allFinite()) return false;
      now.bodies.push_back(motion);
    }
    recording.snapshots.push_back(std::move(now));
    return true;
  }

 private:
  static constexpr double margin = 0.04;  ///< Bullet's own at 1 m, over a

  void addBody(double mass, const btVector3& inertia, std::unique_ptr<btCollisionShape> shape, const SceneBody& each) {
    world.addBody({mass, each.pose, each.velocity, each.spin, setup.friction, setup.restitution}, inertia,
                  std::move(shape));
  }

  const SceneSetup& setup;
  const double scale;
  BulletWorld world;
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
