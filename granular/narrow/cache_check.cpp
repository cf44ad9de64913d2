#include "granular/narrow/cache_check.h"

#include <utility>

#include "granular/narrow/support_piece.h"
#include "granular/shape/polyhedron.h"

namespace granular {
namespace {

bool isBelow(std::int32_t index, std::size_t count) { return index >= 0 && static_cast<std::size_t>(index) < count; }

bool isVertex(const Shape& shape, std::int32_t index) { return isBelow(index, tablesOf(shape)->vertices.size()); }
bool isEdge(const Shape& shape, std::int32_t index) { return isBelow(index, tablesOf(shape)->edges.size()); }
bool isFace(const Shape& shape, std::int32_t index) { return isBelow(index, tablesOf(shape)->faces.size()); }

/// The code of a piece that the shape has, or 0.
bool isPiece(const Shape& shape, std::int32_t code) {
  if (code == 0) return true;
  const PieceName name = decodePiece(code);
  if (code < 0 || name.kind > PieceName::face) return false;
  if (tablesOf(shape) == nullptr) return name.index <= 1;
  switch (name.kind) {
    case PieceName::point:
      return isVertex(shape, name.index);
    case PieceName::edge:
      return isEdge(shape, name.index);
    case PieceName::face:
      return isFace(shape, name.index);
    default:
      return false;
  }
}

/// Axes of two cuboids, by number.
bool namesAxes(const WarmCache& cache) {
  return cache.touched == 0 ||
         (cache.kind != WarmCache::smooth && isBelow(cache.featureA, 3) && isBelow(cache.featureB, 3));
}

/// Features of two polyhedra, one of which may be a cuboid.
bool namesFlatFeatures(const WarmCache& cache, const Shape& a, const Shape& b) {
  switch (cache.kind) {
    case WarmCache::apart:
      return isVertex(a, cache.featureA) && isVertex(b, cache.featureB);
    case WarmCache::faceOfA:
      return isFace(a, cache.featureA) && isVertex(b, cache.featureB);
    case WarmCache::faceOfB:
      return isVertex(a, cache.featureA) && isFace(b, cache.featureB);
    case WarmCache::edgePair:
      return isEdge(a, cache.featureA) && isEdge(b, cache.featureB);
    default:
      return true;
  }
}

/// The feature of a polyhedron that is nearest to a sphere.
bool namesNearest(const WarmCache& cache, const Shape& b) {
  switch (cache.kind) {
    case WarmCache::faceOfB:
      return isFace(b, cache.featureB);
    case WarmCache::edgePair:
      return isEdge(b, cache.featureB);
    case WarmCache::smooth:
      return isVertex(b, cache.featureB);
    default:
      return true;
  }
}

}  // namespace

bool cacheFits(const WarmCache& cache, const Shape& a, const Shape& b) {
  if (a.kind() > b.kind()) return cacheFits(cache, b, a);
  if (cache.kind < WarmCache::cold || cache.kind > WarmCache::smooth) return false;
  if (cache.kind == WarmCache::cold && cache.touched == 0) return true;
  // As the table of kernels has it (kernel_table.cpp).
  const ShapeKind first = a.kind(), second = b.kind();
  if (first == ShapeKind::cuboid && second == ShapeKind::cuboid) return namesAxes(cache);
  if (tablesOf(a) != nullptr && tablesOf(b) != nullptr) return namesFlatFeatures(cache, a, b);
  if (first == ShapeKind::sphere) return second != ShapeKind::polyhedron || namesNearest(cache, b);
  return isPiece(a, cache.featureA) && isPiece(b, cache.featureB);
}

}  // namespace granular
