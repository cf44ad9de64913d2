// Places of bodies in the structure of arrays: of one alone, or of as many as a register holds numbers, read into lanes
// side by side. Both classes have the same functions, so that a stage is written once for them.
#pragma once

#include "granular/body/motion_rows.h"
#include "granular/core/rows.h"
#include "granular/core/share_out.h"

namespace granular {

/// A MotionRow of one body or of several side by side.
template <class Real>
struct MotionOf {
  Triple<Real> v, w, vHalf, spinHalf;
  Real inverseMass, radiusRatio;
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
  void write(const MotionOf<double>& m, std::vector<MotionRow>& column) const {
    column[i].v = toVec3(m.v);
    column[i].w = toVec3(m.w);
    column[i].inverseMass = m.inverseMass;
    column[i].radiusRatio = m.radiusRatio;
    column[i].vHalf = toVec3(m.vHalf);
    column[i].spinHalf = toVec3(m.spinHalf);
  }
  void write(const Triple<double>& x, double radius, std::vector<BallRow>& column) const {
    column[i] = {toVec3(x), radius};
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
  /// Whole lines of the cache: they need not be read for it.
  void write(const MotionOf<Wide>& m, std::vector<MotionRow>& column) const {
    std::array<double*, count> now, half;
    for (std::size_t k = 0; k < count; ++k) {
      now[k] = column[at(k)].v.data();
      half[k] = column[at(k)].vHalf.data();
    }
    storeRows<8>({m.v.x, m.v.y, m.v.z, m.w.x, m.w.y, m.w.z, m.inverseMass, m.radiusRatio}, now, count);
    storeRows<8>({m.vHalf.x, m.vHalf.y, m.vHalf.z, m.spinHalf.x, m.spinHalf.y, m.spinHalf.z, Wide{}, Wide{}}, half,
                 count);
  }
  void write(const Triple<Wide>& x, const Wide& radius, std::vector<BallRow>& column) const {
    store<4>(column.data()->x.data(), [&](double* rows) {
      storeRows(Quadruple<Wide>{x.x, x.y, x.z, radius}, 4, rows);
    });
  }

 private:
  // Rows lie one behind the other.
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Quat) == 4 * sizeof(double));
  static_assert(sizeof(Frame) == 12 * sizeof(double));

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
