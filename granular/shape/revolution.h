// What the round shapes share: checked lengths, circles of sample points, and triangulations of surfaces of revolution.
#pragma once

#include <span>
#include <string>

#include "granular/shape/shape.h"

namespace granular {

/// Throws InputError naming shape and parameter unless the length (m) is finite and above 0.
void requireLength(const std::string& shape, const std::string& parameter, double metres);

/// Unit vector of the direction of d seen along z; x for d along z.
inline Vec2 azimuthOf(const Vec3& d) {
  const double across = std::sqrt(d.x() * d.x() + d.y() * d.y());
  return across > 0 ? Vec2(d.x() / across, d.y() / across) : Vec2(1, 0);
}

/// Cosine and sine of faceSamples angles around the circle, from 0 on.
struct RimAngles {
  alignas(64) double cosine[faceSamples], sine[faceSamples];
};
const RimAngles& rimAngles();

/// Point k of faceSamples on the circle (radius, z), counter-clockwise about z, point 0 at the azimuth `first`.
Vec3 rimPoint(double radius, double z, const Vec2& first, int k);

/// The closed triangulation of the profile turned about z. profile: (distance from the axis, z) from the lowest point
/// to the highest, both ends on the axis, none between. Outward triangles. segments >= 3 around the circle.
TriangleMesh revolve(std::span<const Vec2> profile, int segments);

/// A triangulated ellipsoid; resolution segments around, half as many from pole to pole.
TriangleMesh ellipsoidMesh(const Vec3& semiAxes, int resolution);

}  // namespace granular
