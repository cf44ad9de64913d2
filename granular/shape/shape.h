// A shape in its body frame, convex but for clumps (shape/clump.h): origin at the centre of mass, axes along the
// principal axes of inertia (S section 2.2). The virtual interface serves set-up, cold starts, analysis and output;
// kernels of the force loop take a concrete type.
#pragma once

#include <array>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "granular/shape/feature.h"
#include "granular/shape/mass_properties.h"

class btConvexShape;

namespace granular {

/// A round face, body axes.
struct Disk {
  Vec3 centre, normal;  ///< m; outwards, unit
  double radius;        ///< m
};

enum class ShapeKind : unsigned char { sphere, ellipsoid, cylinder, cone, cuboid, polyhedron, bullet, clump };
inline constexpr int shapeKindCount = 8;

/// A closed triangle mesh, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
};

class Shape {
 public:
  virtual ~Shape() = default;
  Shape(const Shape&) = delete;
  Shape& operator=(const Shape&) = delete;

  ShapeKind kind() const { return shapeKind; }
  const MassProperties& massProperties() const { return mass; }
  /// Largest distance of a surface point from the centre of mass, m.
  double boundingRadius() const { return outerRadius; }
  /// Radius of a ball about the centre of mass that lies inside, m.
  double innerRadius() const { return insideRadius; }
  /// True for a ball about the centre of mass: it looks the same however it lies.
  bool isRound() const { return insideRadius == outerRadius; }
  /// Radius of the sphere of equal volume, m: the "size" of every relative measure.
  double size() const { return equalVolumeRadius; }
  /// Longest extent over all directions, m (beds are measured in it).
  double longestExtent() const { return longest; }
  /// Unit director of the order parameters (S appendix B): the minor axis for aspect < 1, the major axis otherwise;
  /// irregular bodies: the principal axis whose moment differs most from the other two.
  const Vec3& director() const { return axis; }

  /// The surface point furthest along direction d (any length > 0), body frame (S table 5).
  virtual Vec3 support(const Vec3& d) const = 0;

  /// The part of the shape within slab (m, >= 0) below the supporting plane of the unit direction d, as a Feature in
  /// order around d. Polyhedra: the convex hull, seen along d, of all vertices in the slab (the whole set if it fits,
  /// else the deepest). Flat faces of cylinders and cones are sampled as polygons of faceSamples points, the first of
  /// them at the support azimuth; their sides are segments; other curved surfaces give their support point.
  virtual void supportFeature(const Vec3& d, double slab, Feature& out) const = 0;

  /// The flat face whose outward normal is closest to the unit direction d, if their cosine is at least minCosine;
  /// otherwise the straight edge or generator that supports d (two points), otherwise the support point.
  /// Returns the outward unit normal of the face, or d itself for a segment or point.
  virtual Vec3 supportFace(const Vec3& d, double minCosine, Feature& out) const = 0;

  /// True if what supportFace gives is a round face, whose faceSamples points need not be asked for then; otherwise out
  /// is of no account.
  virtual bool supportDisk(const Vec3& /*d*/, double /*minCosine*/, Disk& /*out*/) const { return false; }

  /// True if p (body frame) lies inside or on the surface.
  virtual bool contains(const Vec3& p) const = 0;

  /// A closed triangulation for pictures and files; resolution: segments around a full circle of a curved surface.
  virtual TriangleMesh surface(int resolution) const = 0;

  /// A Bullet shape of this one multiplied by scale, zero margin. Owned by the caller.
  virtual std::unique_ptr<btConvexShape> makeBulletShape(double scale) const = 0;

  /// "cuboid 3 x 3 x 3 mm", for messages.
  virtual std::string describe() const = 0;

  /// Exact bounds of the shape placed at frame, world axes.
  virtual Aabb bounds(const Frame& frame) const;

 protected:
  explicit Shape(ShapeKind kind) : shapeKind(kind) {}
  /// To be called once by a constructor, when support() works.
  void setMeasures(const MassProperties& properties, double bounding, double inner, double longestLength,
                   const Vec3& directorAxis);
  /// The measures of source multiplied by factor (dimensionless, > 0), instead of setMeasures.
  void setScaledMeasures(const Shape& source, double factor);

 private:
  ShapeKind shapeKind;
  MassProperties mass;
  double outerRadius = 0;
  double insideRadius = 0;
  double equalVolumeRadius = 0;
  double longest = 0;
  Vec3 axis = Vec3::UnitZ();
};

/// The coordinate axis along which a body with these three measures (semi-axes, half-lengths, moments) is unlike the
/// other two: the largest or the smallest, whichever is further from the middle one. Near ties (1e-9) go to the largest
/// or the smallest as asked, and a body equal in all three gets z.
Vec3 distinctAxis(const Vec3& measures, bool preferLargest);

/// A length for messages: 3 significant digits or more in m, mm or um.
std::string describeLength(double metres);
/// Several lengths in one unit: "3 x 3 x 3 mm".
std::string describeLengths(std::initializer_list<double> metres);

/// How many points stand for a circle when a flat round face is clipped. They lie on the rim, so that no contact point
/// leaves the body: the polygon's area is sin(2 pi/N)/(2 pi/N) of the disk's, 0.64 % too small for N = 32.
inline constexpr int faceSamples = 32;

}  // namespace granular
