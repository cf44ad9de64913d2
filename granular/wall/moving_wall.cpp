// A wall that moves: a wall at rest in axes of its own, which are carried about. Bodies are seen from those axes, and
// what is found is turned back.
#include "granular/wall/wall.h"

namespace granular {
namespace {

class MovingWall final : public Wall {
 public:
  MovingWall(std::unique_ptr<Wall> wallAtRest, const WallPath& prescribed, const WallServo& pressing)
      : atRest(std::move(wallAtRest)), path(prescribed), servo(pressing) {
    name = atRest->name;
    material = atRest->material;
    place(0);
    stepMotion = motion;
  }

  void touch(const RuleOptions& rule, const Shape& shape, const Frame& frame,
             std::vector<WallTouch>& out) const override {
    const std::size_t first = out.size();
    atRest->touch(rule, shape, {axes.R.transpose() * frame.R, axes.toBody(frame.x)}, out);
    for (std::size_t k = first; k < out.size(); ++k) {
      WallTouch& touch = out[k];
      touch.normal = axes.rotate(touch.normal);
      touch.patch.point = axes.toWorld(touch.patch.point);
      touch.patch.centre = axes.toWorld(touch.patch.centre);
      touch.patch.u = axes.rotate(touch.patch.u);
    }
  }
  double clearance(const Vec3& centre, double radius) const override {
    return atRest->clearance(axes.toBody(centre), radius);
  }
  bool admits(const Vec3& p) const override { return atRest->admits(axes.toBody(p)); }
  bool isFlat() const override { return atRest->isFlat(); }
  Mat3 curvatureAt(const Vec3& p) const override {
    return axes.R * atRest->curvatureAt(axes.toBody(p)) * axes.R.transpose();
  }
  std::string describe() const override { return "moving " + atRest->describe(); }

  bool moves() const override { return true; }
  double stopTime() const override { return path.moves() ? path.stop : 0; }
  const WallServo* heldBy() const override { return servo.moves() ? &servo : nullptr; }

  void place(double time) override {
    const WallMotion before = motion;
    axes = path.placeAt(time);
    motion = path.motionAt(time);
    const Vec3 pressed = servoWay * servo.direction;
    axes.x += pressed;
    motion.reference += pressed;
    motion.velocity += servoSpeed * servo.direction;
    stepMotion = {motion.reference, 0.5 * (before.velocity + motion.velocity), 0.5 * (before.spin + motion.spin)};
  }

 private:
  std::unique_ptr<Wall> atRest;
  WallPath path;
  WallServo servo;
  Frame axes;
};

}  // namespace

std::unique_ptr<Wall> makeMovingWall(std::unique_ptr<Wall> atRest, const WallPath& path, const WallServo& servo) {
  if (!path.moves() && !servo.moves()) return atRest;
  return std::make_unique<MovingWall>(std::move(atRest), path, servo);
}

}  // namespace granular
