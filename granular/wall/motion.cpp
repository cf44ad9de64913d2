#include "granular/wall/motion.h"

#include <algorithm>

namespace granular {

Frame WallPath::placeAt(double time) const {
  const double t = std::clamp(time, start, stop) - start;
  const double swing = std::sin(phase + 2 * pi * frequency * t) - std::sin(phase);
  const Vec3 shift = t * velocity + swing * amplitude;
  const double rate = spin.norm();
  if (rate == 0) return {Mat3::Identity(), shift};
  const Mat3 turn = Eigen::AngleAxisd(rate * t, spin / rate).toRotationMatrix();
  return {turn, axisPoint - turn * axisPoint + shift};
}

WallMotion WallPath::motionAt(double time) const {
  WallMotion motion;
  motion.reference = placeAt(time).toWorld(axisPoint);
  if (time < start || time >= stop) return motion;
  const double w = 2 * pi * frequency;
  motion.velocity = velocity + w * std::cos(phase + w * (time - start)) * amplitude;
  motion.spin = spin;
  return motion;
}

double WallServo::speedFor(double pressed, double stiffness) const {
  const double missing = force - pressed;
  if (!(stiffness > 0)) return std::copysign(maxSpeed, missing);
  return std::clamp(missing / (response * stiffness), -maxSpeed, maxSpeed);
}

}  // namespace granular
