// The tower in Bullet alone, as a baseline. Bullet's tolerances are absolute lengths, so it sees cuboids of 3 units,
// the size it is made for.
#include <chrono>
#include <cmath>

#include "granular/core/errors.h"
#include "granular/run/bullet_world.h"
#include "granular/run/stack_watch.h"
#include "granular/shape/bullet_vectors.h"

namespace granular {
namespace {

/// The tower in Bullet's world: the floor is body 0, cuboid k body k + 1.
class BulletTower {
 public:
  BulletTower(const StackSettings& chosen, const std::vector<Pose>& poses)
      : settings(chosen), scale(3 / chosen.side), world(scale, chosen.gravity, chosen.solverIterations) {
    addBody(0, std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0), {Vec3::Zero(), Quat::Identity()});
    for (int k = 0; k < settings.count; ++k) {
      const Pose& pose = poses[static_cast<std::size_t>(k)];
      addBody(massOf(settings, k), std::make_unique<btBoxShape>(toBullet(scale * halfLengths(settings, k))), pose);
    }
  }

  void step(double dt) {
    world.step(dt);
    contacts += world.countContacts();
  }
  std::vector<Pose> poses() const {
    std::vector<Pose> out;
    for (std::size_t k = 1; k < world.size(); ++k) out.push_back(world.pose(k));
    return out;
  }
  double kineticEnergy() const {
    double sum = 0;
    for (std::size_t k = 1; k < world.size(); ++k) sum += world.kineticEnergy(k);
    return sum;
  }
  double meanSpeed() const {
    double sum = 0;
    for (std::size_t k = 1; k < world.size(); ++k) sum += world.velocity(k).norm();
    return sum / settings.count;
  }
  /// Mean upward force of a step on each cuboid from what is below it, N.
  std::vector<double> layerForces(double dt) const {
    std::vector<double> force(static_cast<std::size_t>(settings.count), 0.0);
    world.visitManifolds([&](const btPersistentManifold& manifold) {
      const int a = manifold.getBody0()->getUserIndex(), b = manifold.getBody1()->getUserIndex();
      for (int c = 0; c < manifold.getNumContacts(); ++c) {
        const btManifoldPoint& point = manifold.getContactPoint(c);
        // The normal points from body 1 to body 0.
        const double onA = point.m_appliedImpulse * point.m_normalWorldOnB.z() / (scale * dt);
        const int upper = std::max(a, b);
        if (upper > 0) force[static_cast<std::size_t>(upper - 1)] += a > b ? onA : -onA;
      }
    });
    return force;
  }
  std::uint64_t contactSteps() const { return contacts; }

 private:
  void addBody(double mass, std::unique_ptr<btCollisionShape> shape, const Pose& pose) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    BulletBody body;
    body.mass = mass;
    body.pose = pose;
    body.friction = settings.contact.friction;
    body.restitution = settings.contact.restitution;
    world.addBody(body, inertia, std::move(shape));
  }

  const StackSettings& settings;
  const double scale;
  BulletWorld world;
  std::uint64_t contacts = 0;
};

}  // namespace

StackResult runBulletStack(const StackSettings& settings, const StackObserver& watch) {
  checkStack(settings);
  require(settings.step > 0, "dt = 0: Bullet needs a time step");
  const std::vector<Pose> placed = placeStack(settings);
  BulletTower tower(settings, placed);
  const double dt = settings.step;
  const auto steps = static_cast<std::int64_t>(std::ceil(settings.time / dt));
  const std::int64_t perSample = std::max<std::int64_t>(1, std::llround(settings.sampleEvery / dt));
  StackWatch watcher(settings, placed);
  const auto began = std::chrono::steady_clock::now();
  std::int64_t k = 0;
  for (bool goOn = true; goOn && k < steps && !watcher.fallen();) {
    tower.step(dt);
    ++k;
    watcher.note(tower.kineticEnergy(), tower.meanSpeed());
    if (k % perSample != 0 && k != steps) continue;
    const StackSample& sample = watcher.sample(static_cast<double>(k) * dt, tower.poses(), tower.layerForces(dt));
    goOn = !watch || watch(sample);
  }
  StackResult result = watcher.finish(static_cast<double>(k) * dt);
  result.wallTime = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  result.step = dt;
  result.steps = k;
  if (tower.contactSteps() > 0) result.nsPerContact = 1e9 * result.wallTime / static_cast<double>(tower.contactSteps());
  result.poses = tower.poses();
  return result;
}

}  // namespace granular
