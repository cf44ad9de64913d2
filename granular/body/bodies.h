// The bodies, as a structure of arrays: what the force loop reads each step apart from what it reads rarely.
// Index = slot: in the order in which bodies came, without those that left, unless the world lays them in an order of
// its own (WorldOptions::keepSlots); id = the stable number a user and a checkpoint know.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "granular/body/body_rows.h"
#include "granular/shape/shape.h"

namespace granular {

/// All shapes of a run; bodies refer to them by index.
using ShapeTable = std::vector<std::shared_ptr<const Shape>>;

enum class BodyState : std::uint8_t { moving, frozen, asleep };

/// Directions of the world in which a body may not move, as bits.
using Locks = std::uint8_t;
inline constexpr Locks lockTranslation(int axis) { return static_cast<Locks>(1 << axis); }
inline constexpr Locks lockRotation(int axis) { return static_cast<Locks>(8 << axis); }
/// What the locks leave of a velocity or force (of a spin), world axes.
inline Vec3 freeTranslation(Locks locks, const Vec3& v) {
  return {locks & 1 ? 0 : v.x(), locks & 2 ? 0 : v.y(), locks & 4 ? 0 : v.z()};
}
inline Vec3 freeRotation(Locks locks, const Vec3& w) { return freeTranslation(static_cast<Locks>(locks >> 3), w); }

/// How a body enters the simulation.
struct NewBody {
  std::int64_t id = 0;
  std::int32_t shapeIndex = 0;
  std::int32_t material = 0;
  double density = 2500;         ///< kg/m^3
  Pose pose;                     ///< at t_n
  Vec3 velocity = Vec3::Zero();  ///< m/s, at t_n
  Vec3 spin = Vec3::Zero();      ///< rad/s, world axes, at t_n
  Locks locks = 0;               ///< velocity and spin lose what they forbid
};

struct Bodies {
  // Hot: state, read and written each step.
  std::vector<BoundingSphere> bounds;  ///< x(), boundingRadius()
  std::vector<MotionRow> motion;       ///< v(), w(), vHalf(), spinHalf(), inverseMass(), radiusRatio()
  std::vector<Vec3> acceleration;      ///< of the last step, world axes, m/s^2
  std::vector<Vec3> alpha;             ///< angular acceleration of the last step, axes as of wHalfOf(), rad/s^2
  std::vector<Vec3> force, torque;     ///< gathered, world axes; torque about the centre of mass
  std::vector<double> travel;          ///< path length of the fastest surface point so far (a bound), m
  // How bodies lie; empty where all are spheres that nobody follows, whose q stays 1 (orientation(), frameOf()).
  std::vector<Quat> q;       ///< orientation at t_n, body to world
  std::vector<Quat> qHalf;   ///< orientation at the half step
  std::vector<Frame> frame;  ///< x and the matrix of q, for the kernels
  // Of bodies that turn by a scheme, body axes; empty where all are balls (wHalfOf(), inertiaOf()).
  std::vector<Vec3> wHalf;                    ///< angular velocity at the half step, rad/s
  std::vector<Vec3> inertia, inverseInertia;  ///< principal, kg m^2; the inverse 0 for bodies that are frozen

  // Properties.
  std::vector<double> mass;  ///< kg
  std::vector<const Shape*> shape;
  std::vector<std::int32_t> shapeIndex, material;

  // Bookkeeping.
  std::vector<std::int64_t> id;  ///< stable, unique
  std::vector<BodyState> state;
  std::vector<Locks> locks;
  /// Balls look the same from all sides and turn as easily about any axis: their spins need no orientation.
  enum class Turning : std::uint8_t { byScheme, ballWithOrientation, ball };
  std::vector<Turning> turning;  ///< of a ball without orientation q stays 1
  /// Bodies that move, but not step by step (world/flight.cpp): 1. Nobody is aloft where state is saved.
  std::vector<std::uint8_t> aloft;

  std::size_t size() const { return bounds.size(); }
  // What the rows hold of body i.
  Vec3& x(std::size_t i) { return bounds[i].x; }
  const Vec3& x(std::size_t i) const { return bounds[i].x; }
  double boundingRadius(std::size_t i) const { return bounds[i].radius; }
  Vec3& v(std::size_t i) { return motion[i].v; }
  const Vec3& v(std::size_t i) const { return motion[i].v; }
  Vec3& w(std::size_t i) { return motion[i].w; }
  const Vec3& w(std::size_t i) const { return motion[i].w; }
  Vec3& vHalf(std::size_t i) { return motion[i].vHalf; }
  const Vec3& vHalf(std::size_t i) const { return motion[i].vHalf; }
  /// For the spring increments.
  Vec3& spinHalf(std::size_t i) { return motion[i].spinHalf; }
  const Vec3& spinHalf(std::size_t i) const { return motion[i].spinHalf; }
  double inverseMass(std::size_t i) const { return motion[i].inverseMass; }
  double radiusRatio(std::size_t i) const { return motion[i].radiusRatio; }

  bool moves(std::size_t i) const { return state[i] == BodyState::moving; }
  /// True if any body ever had a lock.
  bool anyLocked() const { return someLocked; }
  /// Slots of bodies that move, ascending: all, those that turn by a scheme, the balls, and of these the ones whose
  /// orientation is followed.
  struct MovingSlots {
    std::vector<std::int32_t> all, byScheme, balls, orientedBalls;
  };
  /// Of the bodies that move step by step: the stages of motion cost nothing for the others. Listed anew by the first
  /// call after bodies came, went, or changed their state, which must not come from several threads at once.
  const MovingSlots& stepped() const { return listMoving().stepped; }
  const std::vector<std::int32_t>& movingSlots() const { return stepped().all; }
  /// Of those that are aloft.
  const MovingSlots& flying() const { return listMoving().flying; }
  bool anyAloft() const { return someAloft; }
  /// From now on these are aloft; and nobody any more.
  void takeOff(const std::vector<std::int32_t>& slots);
  void land();

  /// Grows with everybody that comes or goes, or begins or ceases to move.
  std::uint64_t changes() const { return changeCount; }

  /// True if q, qHalf and frame hold a row for every body.
  bool haveOrientations() const { return size() == 0 || !q.empty(); }
  /// How body i lies at t_n and at the half step; whatever is kept of it.
  const Quat& orientation(std::size_t i) const { return q.empty() ? noTurn : q[i]; }
  const Quat& orientationHalf(std::size_t i) const { return qHalf.empty() ? noTurn : qHalf[i]; }
  Pose poseOf(std::size_t i) const { return {x(i), orientation(i)}; }
  Frame frameOf(std::size_t i) const { return frame.empty() ? Frame(Mat3::Identity(), x(i)) : frame[i]; }

  bool isBall(std::size_t i) const { return turning[i] != Turning::byScheme; }
  /// Of body i, at the half step: angular velocity, rad/s; body axes, world axes of a ball.
  const Vec3& wHalfOf(std::size_t i) const { return isBall(i) ? spinHalf(i) : wHalf[i]; }
  Vec3& wHalfOf(std::size_t i) { return isBall(i) ? spinHalf(i) : wHalf[i]; }
  /// Principal moments of inertia, kg m^2, and their inverses (0 for bodies that are frozen); body axes.
  Vec3 inertiaOf(std::size_t i) const { return isBall(i) ? Vec3::Constant(motion[i].inertia) : inertia[i]; }
  Vec3 inverseInertiaOf(std::size_t i) const {
    return isBall(i) ? Vec3::Constant(inverseMass(i) == 0 ? 0 : 1 / motion[i].inertia) : inverseInertia[i];
  }
  /// Of slot i: a spin in the axes of wHalfOf(), in world axes at t_n.
  Vec3 spinToWorld(std::size_t i, const Vec3& spin) const { return isBall(i) ? spin : frame[i].rotate(spin); }

  /// Of slot i, J: with a velocity in world axes and a spin in body axes, and with those at t_n.
  double kineticEnergy(std::size_t i, const Vec3& velocity, const Vec3& bodySpin) const {
    return 0.5 * (mass[i] * velocity.squaredNorm() + bodySpin.dot(inertiaOf(i).cwiseProduct(bodySpin)));
  }
  double kineticEnergy(std::size_t i) const { return kineticEnergy(i, v(i), frameOf(i).unrotate(w(i))); }

  /// Makes room for so many bodies in all.
  void reserve(std::size_t count);
  /// Appends a body; returns its slot. The half steps are started by the integrator. ofBalls: how it turns if it is
  /// one.
  std::size_t add(const NewBody& body, const Shape& bodyShape, Turning ofBalls = Turning::byScheme);

  /// Takes a body out of the motion: no velocity, infinite mass, until release() gives them back.
  void hold(std::size_t i, BodyState as);
  void release(std::size_t i);

  /// Body order[k] moves to slot k; those that it does not name, each at most once, are removed.
  void rearrange(const std::vector<std::int32_t>& order);
  /// All slots, those of lower ids first.
  std::vector<std::int32_t> slotsById() const;

  /// Calls visit(name, column) for every array of state that a checkpoint must hold, after makeTurnColumns if it is to
  /// be saved. Throws InputError if visit gives a part of the rows another length than to x.
  template <class Visitor>
  void visitState(Visitor&& visit) {
    visitRows(visit, "x", bounds, &BoundingSphere::x);
    motion.resize(size());
    visit("q", q);
    visitRows(visit, "v", motion, &MotionRow::v);
    visitRows(visit, "w", motion, &MotionRow::w);
    visitRows(visit, "v_half", motion, &MotionRow::vHalf);
    visit("w_half", wHalf);
    visit("q_half", qHalf);
    visitRows(visit, "spin_half", motion, &MotionRow::spinHalf);
    visit("acceleration", acceleration);
    visit("alpha", alpha);
    visit("force", force);
    visit("torque", torque);
    visit("travel", travel);
    visit("mass", mass);
    visitRows(visit, "inverse_mass", motion, &MotionRow::inverseMass);
    visit("inertia", inertia);
    visit("inverse_inertia", inverseInertia);
    visitRows(visit, "radius_ratio", motion, &MotionRow::radiusRatio);
    visit("shape_index", shapeIndex);
    visit("material", material);
    visit("id", id);
    visit("state", state);
    visit("locks", locks);
  }

  /// Puts into wHalf and the moments what balls have in their rows.
  void makeTurnColumns();
  /// Drops the columns that nobody needs.
  void leaveOutNeedless();
  /// Rebuilds what follows from the state: how bodies turn, frames, shape pointers, bounding radii.
  void restoreDerived(const ShapeTable& shapes, Turning ofBalls);

 private:
  inline static const Quat noTurn = Quat::Identity();
  /// How a body of this shape and inertia turns.
  static Turning turningOf(const Shape& bodyShape, const Vec3& moments, Turning ofBalls);
  /// True if it needs no row of q, qHalf and frame.
  static bool staysUpright(const Shape& bodyShape, Turning turns) {
    return turns == Turning::ball && bodyShape.kind() == ShapeKind::sphere;
  }
  /// Makes q, qHalf and frame unless they are there.
  void makeOrientations();
  /// Calls visit(column) for every array; for those that may be left out.
  template <class Visitor>
  void visitColumns(Visitor&& visit);
  template <class Visitor>
  void visitColumnsOfSome(Visitor&& visit);
  /// A part of the rows is to have another length: x may, and all others must follow.
  static void resizeRows(const char*, std::size_t count, std::vector<BoundingSphere>& rows) { rows.resize(count); }
  static void resizeRows(const char* name, std::size_t count, std::vector<MotionRow>& rows);
  /// Calls visit(name, column) with what the rows hold in one place.
  template <class Visitor, class Row, class Value>
  void visitRows(Visitor&& visit, const char* name, std::vector<Row>& rows, Value Row::*place) {
    std::vector<Value> column(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) column[i] = rows[i].*place;
    visit(name, column);
    resizeRows(name, column.size(), rows);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*place = column[i];
  }
  struct MovingList {
    MovingSlots stepped, flying;
  };
  const MovingList& listMoving() const;
  void noteChange() {
    listStale = true;
    ++changeCount;
  }
  mutable MovingList listed;
  mutable bool listStale = true;
  std::uint64_t changeCount = 0;
  bool someLocked = false, someAloft = false;
};

}  // namespace granular
