// Each round asks every face that is still too far below its supporting plane for the point there, as EPA does for one
// face.
#include "granular/shape/support_polytope.h"

namespace granular {

std::vector<Vec3> firstSupportPoints(const SupportFunction& support) {
  std::vector<Vec3> points;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      for (int k = -1; k <= 1; ++k) {
        if (i != 0 || j != 0 || k != 0) points.push_back(support(Vec3(i, j, k).normalized()));
      }
    }
  }
  return points;
}

SupportPolytope refineSupportPolytope(const SupportFunction& support, double tolerance, std::size_t maxVertices,
                                      std::vector<Vec3>& points) {
  constexpr int maxRounds = 40;
  for (int round = 0;; ++round) {
    SupportPolytope polytope;
    polytope.hull = convexHull(points);
    const ConvexHull& hull = polytope.hull;
    points = hull.vertices;
    bool grown = false;
    for (std::size_t f = 0; f < hull.faces.size(); ++f) {
      const Vec3& normal = hull.normals[f];
      const auto& corners = hull.faces[f];
      const Vec3& first = hull.vertices[static_cast<std::size_t>(corners[0])];
      const Vec3 furthest = support(normal);
      const double gap = std::max(0.0, normal.dot(furthest - first));
      double area = 0;
      for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
        const Vec3 a = hull.vertices[static_cast<std::size_t>(corners[k])] - first;
        const Vec3 b = hull.vertices[static_cast<std::size_t>(corners[k + 1])] - first;
        area += a.cross(b).norm() / 2;
      }
      polytope.gaps.push_back(gap);
      polytope.missing += area * gap;
      if (gap > tolerance && points.size() < maxVertices) {
        points.push_back(furthest);
        grown = true;
      }
    }
    if (!grown || round == maxRounds) {
      points = hull.vertices;
      return polytope;
    }
  }
}

}  // namespace granular
