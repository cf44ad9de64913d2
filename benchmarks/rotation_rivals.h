// Schemes that serve for comparison alone, one struct each with the same two functions as the adapter of the library's:
// start(dt, ...) and step(...), which leaves orientation and angular velocity (world axes) at t_{n+1}. The torque is a
// function of both. `torques`: how often a step asks for it.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransformUtil.h>

#include <memory>

#include "granular/integrate/integrator.h"
#include "granular/integrate/small_rotation.h"

namespace granular {

/// One of the library's schemes behind the common signature.
class LibraryScheme {
 public:
  static constexpr int torques = 1;
  explicit LibraryScheme(SchemeKind kind) : scheme(rotationScheme(kind)) {}

  template <class Torque>
  void start(double dt, const Vec3& moments, const Torque& torque, const Quat& q, const Vec3& w) {
    inertia = moments;
    inverse = moments.cwiseInverse();
    scheme.start(dt, inertia, inverse, torque(q, w), q, w, {qHalf, wHalf, alpha});
  }
  template <class Torque>
  void step(double dt, const Torque& torque, Quat& q, Vec3& w) {
    scheme.predict(dt, qHalf, wHalf, alpha, q, w);
    scheme.advance(dt, inertia, inverse, torque(q, w), q, w, {qHalf, wHalf, alpha});
  }

 private:
  const RotationScheme& scheme;
  Vec3 inertia, inverse;
  Quat qHalf;
  Vec3 wHalf, alpha;
};

/// Predictor-corrector direct multiplication (Zhao & van Wachem, Acta Mechanica 224, 3091, 2013): orientation and
/// angular velocity at whole steps, a second torque at the predicted middle of the step.
class PredictorCorrector {
 public:
  static constexpr int torques = 2;

  template <class Torque>
  void start(double, const Vec3& moments, const Torque&, const Quat& q, const Vec3& w) {
    inertia = moments;
    inverse = moments.cwiseInverse();
    wBody = q.conjugate() * w;
  }
  template <class Torque>
  void step(double dt, const Torque& torque, Quat& q, Vec3& w) {
    const Vec3 a = accelerateRotation(inertia, inverse, q.conjugate() * torque(q, w), wBody);
    const Quat middle = rotateByStep(0.5 * dt * (q * Vec3(wBody + 0.25 * dt * a))) * q;
    const Vec3 wMiddle = wBody + 0.5 * dt * a, world = middle * wMiddle;
    const Vec3 aMiddle = accelerateRotation(inertia, inverse, middle.conjugate() * torque(middle, world), wMiddle);
    q = rotateByStep(dt * world) * q;
    keepUnit(q);
    wBody += dt * aMiddle;
    w = q * wBody;
  }

 private:
  Vec3 inertia, inverse, wBody;
};

/// Symplectic splitting into kicks and rotations about the principal axes (Dullweber, Leimkuhler & McLachlan, J. Chem.
/// Phys. 107, 5840, 1997). For a torque that depends on the velocity, the second kick takes it predicted from the first
/// one, as the default scheme does.
class Splitting {
 public:
  static constexpr int torques = 1;

  template <class Torque>
  void start(double, const Vec3& moments, const Torque& torque, const Quat& q, const Vec3& w) {
    inertia = moments;
    momentum = inertia.cwiseProduct(q.conjugate() * w);
    force = q.conjugate() * torque(q, w);
  }
  template <class Torque>
  void step(double dt, const Torque& torque, Quat& q, Vec3& w) {
    momentum += 0.5 * dt * force;
    turn(0, 0.5 * dt, q);
    turn(1, 0.5 * dt, q);
    turn(2, dt, q);
    turn(1, 0.5 * dt, q);
    turn(0, 0.5 * dt, q);
    keepUnit(q);
    // The last force, still in body axes, predicts the momentum of t_{n+1}.
    const Vec3 predicted = momentum + 0.5 * dt * force;
    force = q.conjugate() * torque(q, q * predicted.cwiseQuotient(inertia));
    momentum += 0.5 * dt * force;
    w = q * momentum.cwiseQuotient(inertia);
  }

 private:
  /// Turns about one principal axis with its share of the kinetic energy alone.
  void turn(int axis, double time, Quat& q) {
    const Quat by = rotateByStep(time * momentum[axis] / inertia[axis] * Vec3::Unit(axis));
    momentum = by.conjugate() * momentum;
    q = q * by;
  }

  Vec3 inertia, momentum, force;
};

/// Bullet's body as its sequential-impulse solver moves it: torque, one of the gyroscopic modes, then the transform.
class BulletScheme {
 public:
  enum class Mode { none, explicitForce, implicitWorld, implicitBody };
  static constexpr int torques = 1;
  explicit BulletScheme(Mode chosen) : mode(chosen) {}

  template <class Torque>
  void start(double, const Vec3& moments, const Torque&, const Quat& q, const Vec3& w) {
    btRigidBody::btRigidBodyConstructionInfo info(1, nullptr, nullptr, {moments.x(), moments.y(), moments.z()});
    info.m_startWorldTransform.setRotation({q.x(), q.y(), q.z(), q.w()});
    info.m_startWorldTransform.setOrigin({0, 0, 0});
    body = std::make_shared<btRigidBody>(info);
    body->setAngularVelocity({w.x(), w.y(), w.z()});
  }
  template <class Torque>
  void step(double dt, const Torque& torque, Quat& q, Vec3& w) {
    const Vec3 t = torque(q, w);
    btVector3 change = body->getInvInertiaTensorWorld() * btVector3(t.x(), t.y(), t.z()) * dt;
    switch (mode) {
      case Mode::none:
        break;
      case Mode::explicitForce:
        change -= body->getInvInertiaTensorWorld() * body->computeGyroscopicForceExplicit(SIMD_INFINITY) * dt;
        break;
      case Mode::implicitWorld:
        change += body->computeGyroscopicImpulseImplicit_World(dt);
        break;
      case Mode::implicitBody:
        change += body->computeGyroscopicImpulseImplicit_Body(dt);
        break;
    }
    body->setAngularVelocity(body->getAngularVelocity() + change);
    btTransform next;
    btTransformUtil::integrateTransform(body->getWorldTransform(), {0, 0, 0}, body->getAngularVelocity(), dt, next);
    body->setWorldTransform(next);
    body->updateInertiaTensor();

    const btQuaternion turned = next.getRotation();
    const btVector3& spin = body->getAngularVelocity();
    q = Quat(turned.w(), turned.x(), turned.y(), turned.z());
    w = Vec3(spin.x(), spin.y(), spin.z());
  }

 private:
  Mode mode;
  std::shared_ptr<btRigidBody> body;  // made anew by each start
};

}  // namespace granular
