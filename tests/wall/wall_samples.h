// Bodies, poses and meshes that the wall tests share.
#pragma once

#include <memory>

#include "granular/core/random.h"
#include "granular/shape/cone.h"
#include "granular/shape/cylinder.h"
#include "granular/shape/ellipsoid.h"
#include "granular/shape/polyhedron.h"
#include "granular/shape/sphere.h"
#include "granular/wall/wall.h"

namespace granular::sample {

/// One body of every kind, about 3 mm.
inline std::vector<std::unique_ptr<Shape>> bodies() {
  std::vector<std::unique_ptr<Shape>> all;
  all.push_back(std::make_unique<Sphere>(0.0015));
  all.push_back(std::make_unique<Ellipsoid>(Vec3(0.0015, 0.001, 0.003)));
  all.push_back(std::make_unique<Cylinder>(0.0015, 0.004));
  all.push_back(std::make_unique<Cone>(0.0015, 0.003));
  all.push_back(std::make_unique<Cuboid>(Vec3(0.0015, 0.001, 0.002)));
  Random random(77);
  std::vector<Vec3> points;
  for (int k = 0; k < 24; ++k) points.push_back(0.002 * random.direction());
  all.push_back(std::make_unique<Polyhedron>(points));
  return all;
}

/// A square sheet about the origin in the plane z = 0, normals along +z: cells x cells squares cut in two; with
/// slivers, each vertex of a row is moved along x to within 1e-5 of a cell of its neighbour.
inline TriangleMesh sheet(double side, int cells, bool slivers = false) {
  TriangleMesh mesh;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      double x = double(i);
      // Pairs of columns nearly meet: triangles of aspect 1e5 beside fat ones.
      if (slivers && i % 2 == 1 && i < cells) x = i + 1 - 1e-5;
      mesh.vertices.push_back(side * Vec3(x / cells - 0.5, double(j) / cells - 0.5, 0));
    }
  const auto at = [&](int i, int j) { return j * (cells + 1) + i; };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// Rough ground below z = 0: a sheet of waves, `height` from crest to trough.
inline TriangleMesh ground(double side, int cells, double height, double waves) {
  TriangleMesh mesh = sheet(side, cells);
  for (Vec3& v : mesh.vertices)
    v.z() = 0.5 * height * (std::sin(2 * pi * waves * v.x() / side) * std::cos(1.7 * pi * waves * v.y() / side) - 1);
  return mesh;
}

inline TriangleMesh placed(TriangleMesh mesh, const Frame& frame) {
  for (Vec3& v : mesh.vertices) v = frame.toWorld(v);
  return mesh;
}

inline std::vector<WallTouch> touchesOf(const Wall& wall, const Shape& shape, const Frame& frame,
                                        PointRule rule = RuleOptions{}.rule) {
  std::vector<WallTouch> touches;
  RuleOptions options;
  options.rule = rule;
  wall.touch(options, shape, frame, touches);
  return touches;
}

/// Moves the body along `up` until it reaches `overlap` below the plane through `point` with normal `up`.
inline Frame lowered(const Shape& shape, Frame frame, const Vec3& point, const Vec3& up, double overlap) {
  const Vec3 lowest = frame.toWorld(shape.support(frame.unrotate(-up)));
  frame.x += up * (up.dot(point - lowest) - overlap);
  return frame;
}

/// Force per k_n and moment about `origin` of all contacts.
struct Wrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
};
inline Wrench wrenchOf(const std::vector<WallTouch>& touches, const Vec3& origin) {
  Wrench sum;
  for (const WallTouch& touch : touches) {
    const Vec3 force = -touch.share * touch.overlap * touch.normal;
    sum.force += force;
    sum.moment += (touch.patch.point - origin).cross(force);
  }
  return sum;
}

}  // namespace granular::sample
