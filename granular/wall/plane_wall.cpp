// A plane. A convex body touches it at most once: the normal is the plane's, the overlap is the depth of the deepest
// point, and the patch is the part of the body's supporting face that lies below the plane. Exact for every shape.
#include "granular/core/errors.h"
#include "granular/wall/plane_patch.h"

namespace granular {

namespace {

class PlaneWall final : public Wall {
 public:
  PlaneWall(const Vec3& point, const Vec3& normal) {
    require(point.allFinite() && normal.allFinite() && normal.norm() > 0,
            "plane wall: point and normal must be finite and the normal longer than 0");
    plane.normal = normal.normalized();
    plane.offset = plane.normal.dot(point);
  }

  void touch(const RuleOptions& rule, const Shape& shape, const Frame& frame,
             std::vector<WallTouch>& out) const override {
    if (clearance(frame.x, shape.boundingRadius()) > 0) return;
    const Vec3 deepest = plane.deepest(shape, frame);
    const double overlap = plane.depth(deepest);
    if (!(overlap > 0)) return;
    WallTouch& touch = out.emplace_back();
    touch.normal = -plane.normal;
    touch.overlap = overlap;
    touch.spot = 0;
    touch.share = 1;
    thread_local SunkenSurface surface;
    placeOnPlane(rule, shape, frame, plane, deepest, surface, touch.patch);
  }

  double clearance(const Vec3& centre, double radius) const override { return -plane.depth(centre) - radius; }
  const Plane* asPlane() const override { return &plane; }
  bool admits(const Vec3& p) const override { return plane.depth(p) < 0; }
  std::string describe() const override {
    const auto text = [](double x) { return std::to_string(x); };
    return "plane " + text(plane.normal.x()) + " x + " + text(plane.normal.y()) + " y + " + text(plane.normal.z()) +
           " z = " + text(plane.offset) + " m";
  }

 private:
  Plane plane;
};

}  // namespace

std::unique_ptr<Wall> makePlaneWall(const Vec3& point, const Vec3& normal) {
  return std::make_unique<PlaneWall>(point, normal);
}

}  // namespace granular
