// Walls: geometry of the boundaries, each a list of contacts for a placed shape.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "granular/pair/child_pair.h"
#include "granular/point/contact_point.h"
#include "granular/shape/clump.h"

namespace granular {

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

/// Rigid motion of a wall at t_n: velocity of its reference point and angular velocity about it.
struct WallMotion {
  Vec3 reference = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Vec3 spin = Vec3::Zero();
  Vec3 velocityAt(const Vec3& p) const { return velocity + spin.cross(p - reference); }
};

class Wall {
 public:
  virtual ~Wall() = default;

  /// Appends every contact of the placed convex shape, in order of spot. Thread-safe, depends on the arguments alone.
  virtual void touch(const RuleOptions& rule, const Shape& shape, const Frame& frame,
                     std::vector<WallTouch>& out) const = 0;

  /// Lower bound of the distance from the ball (centre, radius) to this wall's surface, m; negative if it may touch.
  virtual double clearance(const Vec3& centre, double radius) const = 0;

  /// True if the point lies on the granular side.
  virtual bool admits(const Vec3& p) const = 0;

  virtual std::string describe() const = 0;

  std::string name;   ///< as the scene calls it
  int material = 0;   ///< row of the material table
  WallMotion motion;  ///< at rest unless the scene moves it
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

}  // namespace granular
