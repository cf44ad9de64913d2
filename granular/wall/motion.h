// How walls move: as prescribed in time, or by a servo that holds a force.
#pragma once

#include "granular/core/math.h"

namespace granular {

/// Rigid motion of a wall at one time: velocity of a reference point and angular velocity, world axes.
struct WallMotion {
  Vec3 reference = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Vec3 spin = Vec3::Zero();
  Vec3 velocityAt(const Vec3& p) const { return velocity + spin.cross(p - reference); }
};

/// A motion written down in time: a steady translation, a vibration and a turn about an axis, together. World axes; the
/// axis goes along with the translation.
struct WallPath {
  Vec3 velocity = Vec3::Zero();       ///< m/s
  Vec3 amplitude = Vec3::Zero();      ///< of the vibration, m
  double frequency = 0;               ///< of the vibration, 1/s
  double phase = 0;                   ///< of the vibration at the start, rad: it is amplitude sin(phase + 2 pi f t)
  Vec3 axisPoint = Vec3::Zero();      ///< a point of the axis at the start, m
  Vec3 spin = Vec3::Zero();           ///< along the axis, rad/s
  double start = 0, stop = infinity;  ///< at rest before and after, s

  bool moves() const { return velocity.squaredNorm() + spin.squaredNorm() + amplitude.squaredNorm() * frequency > 0; }
  /// Where the wall's own axes lie at a time, which are the world's until the start.
  Frame placeAt(double time) const;
  WallMotion motionAt(double time) const;
};

/// Presses a wall with a given force: it moves along a direction with (target - force)/(response * stiffness), where
/// force and stiffness are those of its contacts, so that a force that is off decays with the response time; without
/// contacts it moves at its largest speed.
struct WallServo {
  Vec3 direction = Vec3::Zero();  ///< unit, in which the wall presses; zero: no servo
  double force = 0;               ///< target, N
  double maxSpeed = 0;            ///< m/s
  double response = 0;            ///< s

  bool moves() const { return direction.squaredNorm() > 0; }
  /// Signed speed along the direction, m/s. pressed: force of the wall on the bodies along the direction, N; stiffness:
  /// of its contacts together, N/m.
  double speedFor(double pressed, double stiffness) const;
};

}  // namespace granular
