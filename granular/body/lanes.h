// Places of bodies in the structure of arrays: of one alone, or of as many as a register holds numbers, read into lanes
// side by side. Both classes have the same functions, so that a stage is written once for them.
#pragma once

#include "granular/body/bodies.h"
#include "granular/core/rows.h"
#include "granular/core/share_out.h"

namespace granular {

/// What the second half of a MotionRow of one body holds, or of several side by side.
template <class Real>
struct MotionAtHalf {
  Triple<Real> v;
  Real inverseMass;
  Triple<Real> spin;
  Real inertia;
};
/// A BoundingSphere.
template <class Real>
struct SphereOf {
  Triple<Real> x;
  Real radius;
};

/// The body in a slot.
class OneBody {
 public:
  using Real = double;
  static constexpr std::size_t count = 1;
  explicit OneBody(std::size_t slot) : i(slot) {}
  /// The slot of body k of them.
  std::size_t at(std::size_t /*k*/) const { return i; }

  double read(const std::vector<double>& column) const { return column[i]; }
  Triple<double> read(const std::vector<Vec3>& column) const { return toTriple(column[i]); }
  Quadruple<double> read(const std::vector<Quat>& column) const { return toQuadruple(column[i]); }

  void write(double value, std::vector<double>& column) const { column[i] = value; }
  void write(const Triple<double>& value, std::vector<Vec3>& column) const { column[i] = toVec3(value); }
  void write(const Quadruple<double>& value, std::vector<Quat>& column) const { column[i] = toQuat(value); }
  /// The frame of orientation q and position x.
  void write(const Quadruple<double>& q, const Triple<double>& x, std::vector<Frame>& column) const {
    column[i] = Frame(toQuat(q).toRotationMatrix(), toVec3(x));
  }
  /// Nothing where no frames are kept.
  void writePosition(const Triple<double>& x, std::vector<Frame>& column) const {
    if (!column.empty()) column[i].x = toVec3(x);
  }

  SphereOf<double> read(const std::vector<BoundingSphere>& rows) const { return {toTriple(rows[i].x), rows[i].radius}; }
  void write(const SphereOf<double>& sphere, std::vector<BoundingSphere>& rows) const {
    rows[i] = {toVec3(sphere.x), sphere.radius};
  }
  /// One vector of the rows.
  Triple<double> read(const std::vector<MotionRow>& rows, Vec3 MotionRow::*which) const {
    return toTriple(rows[i].*which);
  }
  void write(const Triple<double>& value, std::vector<MotionRow>& rows, Vec3 MotionRow::*which) const {
    rows[i].*which = toVec3(value);
  }
  void writeNow(const Triple<double>& v, const Triple<double>& w, std::vector<MotionRow>& rows) const {
    rows[i].v = toVec3(v);
    rows[i].w = toVec3(w);
  }
  MotionAtHalf<double> readHalf(const std::vector<MotionRow>& rows) const {
    const MotionRow& row = rows[i];
    return {toTriple(row.vHalf), row.inverseMass, toTriple(row.spinHalf), row.inertia};
  }
  void writeHalf(const MotionAtHalf<double>& half, std::vector<MotionRow>& rows) const {
    rows[i].vHalf = toVec3(half.v);
    rows[i].spinHalf = toVec3(half.spin);
  }

 private:
  std::size_t i;
};

/// The bodies in wideSize slots. Consecutive slots are read and written where they lie, others by way of a copy.
class WideBodies {
 public:
  using Real = Wide;
  static constexpr std::size_t count = wideSize;
  /// slots: as many as count, ascending.
  explicit WideBodies(const std::int32_t* slots) : slot(slots), consecutive(slots[count - 1] - slots[0] == count - 1) {}

  /// The slot of body k of them.
  std::size_t at(std::size_t k) const { return static_cast<std::size_t>(slot[k]); }

  Wide read(const std::vector<double>& column) const {
    double rows[count];
    return loadWide(bring<1>(column.data(), rows));
  }
  Triple<Wide> read(const std::vector<Vec3>& column) const {
    double rows[3 * count];
    Triple<Wide> v;
    loadRows(bring<3>(column.data()->data(), rows), v);
    return v;
  }
  Quadruple<Wide> read(const std::vector<Quat>& column) const {
    double rows[4 * count];
    Quadruple<Wide> q;
    loadRows(bring<4>(column.data()->coeffs().data(), rows), 4, q);
    return q;
  }

  void write(const Wide& value, std::vector<double>& column) const {
    store<1>(column.data(), [&](double* rows) { storeWide(value, rows); });
  }
  void write(const Triple<Wide>& v, std::vector<Vec3>& column) const {
    store<3>(column.data()->data(), [&](double* rows) { storeRows(v, rows); });
  }
  void write(const Quadruple<Wide>& q, std::vector<Quat>& column) const {
    store<4>(column.data()->coeffs().data(), [&](double* rows) { storeRows(q, 4, rows); });
  }
  void write(const Quadruple<Wide>& q, const Triple<Wide>& x, std::vector<Frame>& column) const {
    const auto R = q.columns();
    store<12>(column.data()->R.data(), [&](double* rows) {
      storeRows(Quadruple<Wide>{R[0].x, R[0].y, R[0].z, R[1].x}, 12, rows);
      storeRows(Quadruple<Wide>{R[1].y, R[1].z, R[2].x, R[2].y}, 12, rows + 4);
      storeRows(Quadruple<Wide>{R[2].z, x.x, x.y, x.z}, 12, rows + 8);
    });
  }
  void writePosition(const Triple<Wide>& x, std::vector<Frame>& column) const {
    if (column.empty()) return;
    double rows[3 * count];
    storeRows(x, rows);
    for (std::size_t k = 0; k < count; ++k) {
      std::memcpy(column[at(k)].x.data(), rows + 3 * k, 3 * sizeof(double));
    }
  }

  SphereOf<Wide> read(const std::vector<BoundingSphere>& rows) const {
    double copies[4 * count];
    Quadruple<Wide> q;
    loadRows(bring<4>(rows.data()->x.data(), copies), 4, q);
    return {{q.x, q.y, q.z}, q.w};
  }
  void write(const SphereOf<Wide>& sphere, std::vector<BoundingSphere>& rows) const {
    store<4>(rows.data()->x.data(), [&](double* to) {
      storeRows(Quadruple<Wide>{sphere.x.x, sphere.x.y, sphere.x.z, sphere.radius}, 4, to);
    });
  }
  Triple<Wide> read(const std::vector<MotionRow>& rows, Vec3 MotionRow::*which) const {
    std::array<Wide, 3> m;
    loadRows(each<const double*>([&](std::size_t i) { return (rows[i].*which).data(); }), m);
    return {m[0], m[1], m[2]};
  }
  void write(const Triple<Wide>& value, std::vector<MotionRow>& rows, Vec3 MotionRow::*which) const {
    storeRows<3>({value.x, value.y, value.z}, each<double*>([&](std::size_t i) { return (rows[i].*which).data(); }),
                 count);
  }
  void writeNow(const Triple<Wide>& v, const Triple<Wide>& w, std::vector<MotionRow>& rows) const {
    storeRows<6>({v.x, v.y, v.z, w.x, w.y, w.z}, each<double*>([&](std::size_t i) { return rows[i].now(); }), count);
  }
  MotionAtHalf<Wide> readHalf(const std::vector<MotionRow>& rows) const {
    std::array<Wide, 8> m;
    loadRows(each<const double*>([&](std::size_t i) { return rows[i].half(); }), m);
    return {{m[0], m[1], m[2]}, m[3], {m[4], m[5], m[6]}, m[7]};
  }
  /// All of it, a line of the cache: what the bodies are like is what was read.
  void writeHalf(const MotionAtHalf<Wide>& half, std::vector<MotionRow>& rows) const {
    const Triple<Wide>&v = half.v, &spin = half.spin;
    storeRows<8>({v.x, v.y, v.z, half.inverseMass, spin.x, spin.y, spin.z, half.inertia},
                 each<double*>([&](std::size_t i) { return rows[i].half(); }), count);
  }

 private:
  // Rows lie one behind the other.
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Quat) == 4 * sizeof(double));
  static_assert(sizeof(Frame) == 12 * sizeof(double));

  /// what(slot) of each body.
  template <class Value, class What>
  std::array<Value, count> each(const What& what) const {
    std::array<Value, count> values;
    for (std::size_t k = 0; k < count; ++k) values[k] = what(at(k));
    return values;
  }
  /// Where the bodies' rows lie one behind the other: in the column, or copied to `rows`.
  template <std::size_t width>
  const double* bring(const double* column, double* rows) const {
    if (consecutive) return column + width * at(0);
    for (std::size_t k = 0; k < count; ++k) {
      std::memcpy(rows + width * k, column + width * at(k), width * sizeof(double));
    }
    return rows;
  }
  /// Calls put(where the rows shall lie), and brings them into the column if that is elsewhere.
  template <std::size_t width, class Put>
  void store(double* column, const Put& put) const {
    if (consecutive) return put(column + width * at(0));
    double rows[width * count];
    put(rows);
    for (std::size_t k = 0; k < count; ++k) {
      std::memcpy(column + width * at(k), rows + width * k, width * sizeof(double));
    }
  }

  const std::int32_t* slot;
  bool consecutive;
};

/// Calls visit(WideBodies) for as many of `count` slots at once as fit, and visit(OneBody) for those left over, or for
/// all if oneByOne; by several threads if worthwhile. Slots ascend; the calls must not depend on each other.
template <class Visitor>
void visitBodies(const std::int32_t* slots, std::size_t count, bool oneByOne, bool worthwhile, const Visitor& visit) {
  const std::size_t groups = oneByOne ? 0 : count / wideSize, left = count - wideSize * groups;
  shareOutEvenly(groups + left, worthwhile, [&](std::size_t g) {
    if (g < groups) return visit(WideBodies(slots + wideSize * g));
    visit(OneBody(static_cast<std::size_t>(slots[(wideSize - 1) * groups + g])));
  });
}
template <class Visitor>
void visitBodies(const std::vector<std::int32_t>& slots, bool oneByOne, bool worthwhile, const Visitor& visit) {
  visitBodies(slots.data(), slots.size(), oneByOne, worthwhile, visit);
}

}  // namespace granular
