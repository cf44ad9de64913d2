// V = 4/3 pi r³, A = 4 pi r², I = 2/5 V r², <r²> = r².
#include "granular/shape/sphere.h"

#include "granular/core/tolerances.h"
#include "granular/shape/revolution.h"

namespace granular {

Sphere::Sphere(double radius) : Shape(ShapeKind::sphere), r(radius) {
  requireLength("sphere", "radius", radius);
  MassProperties closed;
  closed.volume = 4.0 / 3 * pi * r * r * r;
  closed.area = 4 * pi * r * r;
  closed.inertia = Vec3::Constant(0.4 * closed.volume * r * r);
  closed.meanSquareRadius = r * r;
  setMeasures(closed, r, r, 2 * r, Vec3::UnitZ());
}

void Sphere::supportFeature(const Vec3& d, double, Feature& out) const {
  out.clear();
  out.push(support(d));
}

Vec3 Sphere::supportFace(const Vec3& d, double, Feature& out) const {
  out.clear();
  out.push(support(d));
  return d;
}

bool Sphere::contains(const Vec3& p) const { return p.norm() <= r * (1 + tolerance::onSurface); }

TriangleMesh Sphere::surface(int resolution) const { return ellipsoidMesh(Vec3::Constant(r), resolution); }

std::string Sphere::describe() const { return "sphere of radius " + describeLength(r); }

Aabb Sphere::bounds(const Frame& frame) const {
  Aabb box;
  box.lo = frame.x.array() - r;
  box.hi = frame.x.array() + r;
  return box;
}

}  // namespace granular
