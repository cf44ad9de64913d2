// Walls: geometry of the boundaries, each a list of contacts for a placed shape. A program may bring a wall of its own
// (World::walls; examples/extend/bowl_wall.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "granular/pair/child_pair.h"
#include "granular/point/contact_point.h"
#include "granular/shape/clump.h"
#include "granular/wall/motion.h"

namespace granular {

struct Plane;  // wall/plane_patch.h

/// One contact of a body with a wall; the body is A, the wall B.
struct WallTouch {
  Vec3 normal;     ///< unit, from the body into the wall
  double overlap;  ///< m, > 0
  std::int32_t
      spot;      ///< which contact of this body with this wall: numbered by the body's geometry, never by discovery
  double share;  ///< of the stiffness among the spots of one face: 1 for a lone spot
  std::int32_t child = -1;  ///< of a clump; -1 for a body that is none
  ContactPatch patch;
};

class Wall {
 public:
  virtual ~Wall() = default;

  /// Appends every contact of the placed convex shape, in order of spot. The rule is one of the library's
  /// (ruleAtWalls). Thread-safe, depends on the arguments alone, throws nothing.
  virtual void touch(const RuleOptions& rule, const Shape& shape, const Frame& frame,
                     std::vector<WallTouch>& out) const = 0;

  /// Lower bound of the distance from the ball (centre, radius) to this wall's surface, m; negative if it may touch.
  virtual double clearance(const Vec3& centre, double radius) const = 0;

  /// True if the point lies on the granular side.
  virtual bool admits(const Vec3& p) const = 0;

  /// The curvature of its surface at a point of it (shape/curvature.h), world axes, 1/m: 0 where flat, and at the edges
  /// of a mesh too; negative where hollow.
  virtual Mat3 curvatureAt(const Vec3& /*p*/) const { return Mat3::Zero(); }
  /// True if that is 0 everywhere.
  virtual bool isFlat() const { return true; }

  /// The plane that it is, for as long as it lives; null for any other wall.
  virtual const Plane* asPlane() const { return nullptr; }

  virtual std::string describe() const = 0;

  /// True if the wall goes anywhere; then place() must be called for every step.
  virtual bool moves() const { return false; }
  /// When its prescribed motion ends, s; 0 without one.
  virtual double stopTime() const { return 0; }
  /// The servo that presses it, or null.
  virtual const WallServo* heldBy() const { return nullptr; }
  /// Goes to where it is at a time (s), with the way of the servo so far.
  virtual void place(double /*time*/) {}

  std::string name;                     ///< as the scene calls it
  int material = 0;                     ///< row of the material table
  WallMotion motion;                    ///< of its surface at t_n
  WallMotion stepMotion;                ///< the mean over the last step
  double servoWay = 0, servoSpeed = 0;  ///< along the servo's direction, m and m/s
};

/// Appends every contact of a placed shape, of a clump child by child.
void touchWall(const Wall& wall, const RuleOptions& rule, const Shape& shape, const Frame& frame,
               std::vector<WallTouch>& out);
/// The same for one child.
void touchWallWithChild(const Wall& wall, const RuleOptions& rule, const Clump& clump, const Frame& frame,
                        std::int32_t child, std::vector<WallTouch>& out);
/// Fills out with the children that may be nearer to the wall than reach (m, >= 0), in their order.
void findChildrenNearWall(const Wall& wall, const Clump& clump, const Frame& frame, double reach,
                          std::vector<ChildPair>& out);

/// A half space: the granular side is where normal . (x - point) > 0.
std::unique_ptr<Wall> makePlaneWall(const Vec3& point, const Vec3& normal);
/// Inside of an infinite vertical cylinder about the z axis through (axis.x, axis.y), radius in m.
std::unique_ptr<Wall> makeCylinderWall(const Vec2& axis, double radius);
/// A triangle mesh; particles live on the side the triangles' normals point to. Vertices at equal positions are joined;
/// coplanar neighbours act as one facet; shared edges and vertices count once.
std::unique_ptr<Wall> makeMeshWall(const TriangleMesh& mesh, const std::string& source);
/// A wall on a path, pressed by a servo, or both; the given wall itself where neither moves.
std::unique_ptr<Wall> makeMovingWall(std::unique_ptr<Wall> atRest, const WallPath& path, const WallServo& servo);

}  // namespace granular
