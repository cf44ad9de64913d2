// Schemes of motion behind one signature (S equation 1 and its reference 25).
// A step is predict (half-step memory -> state at t_{n+1}, which the contact law reads), one force and torque, and
// advance (-> memory of the next half step). Every scheme must be started from (x_0, v_0, q_0, w_0): without the half
// step it falls to first order. A change of dt is a new start from the state at t_n; single pairs are never
// sub-stepped. A scheme of rotation is a struct in a header of its own (seelen.h, spiral.h); the table serves those who
// choose at run time, one body at a time, and takes schemes that a program adds (addScheme;
// examples/extend/midpoint_scheme.h).
#pragma once

#include <string_view>
#include <vector>

#include "granular/core/math.h"

namespace granular {

/// Euler's equation in body axes: a = I^-1 (T - w x I w). inverseInertia 0 holds the axis.
inline Vec3 accelerateRotation(const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Vec3& w) {
  return inverseInertia.cwiseProduct(torque - w.cross(inertia.cwiseProduct(w)));
}

/// v_{1/2} from v_0 and A_0 (world axes). Vector: Vec3 or Triple.
template <class Vector>
void startTranslation(double dt, const Vector& acceleration, const Vector& v, Vector& vHalf) {
  vHalf = v + 0.5 * dt * acceleration;
}

/// x_{n+1}, and v_{n+1} for the dashpots; acceleration is A_n.
template <class Vector>
void predictTranslation(double dt, const Vector& vHalf, const Vector& acceleration, Vector& x, Vector& v) {
  x = x + dt * vHalf;
  v = vHalf + 0.5 * dt * acceleration;
}

/// v_{n+3/2} from A_{n+1}.
template <class Vector>
void advanceTranslation(double dt, const Vector& acceleration, Vector& vHalf) {
  vHalf = vHalf + dt * acceleration;
}

enum class SchemeKind : unsigned char { seelen, spiral };

/// What a scheme remembers of one body's rotation; references into the arrays that own it.
struct RotationMemory {
  Quat& qHalf;  ///< orientation at the scheme's stored time, body to world
  Vec3& wHalf;  ///< angular velocity at the half step, body axes, rad/s
  Vec3& alpha;  ///< angular acceleration of the last step, body axes, rad/s^2
};

/// One row of the table. Inertia: principal moments, kg m^2; inverseInertia 0 for a fixed body; torque and w in world
/// axes.
struct RotationScheme {
  std::string_view name;  ///< as scene files spell it; a literal
  /// Memory of the first half step from the state and torque at t_0.
  void (*start)(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Quat& q,
                const Vec3& w, RotationMemory memory) = nullptr;
  /// Orientation and predicted angular velocity (world axes) at t_{n+1}.
  void (*predict)(double dt, const Quat& qHalf, const Vec3& wHalf, const Vec3& alpha, Quat& q, Vec3& w) = nullptr;
  /// Memory of the next half step; q and w as predict left them, torque at t_{n+1}.
  void (*advance)(double dt, const Vec3& inertia, const Vec3& inverseInertia, const Vec3& torque, const Quat& q,
                  const Vec3& w, RotationMemory memory) = nullptr;
};

const RotationScheme& rotationScheme(SchemeKind kind);

/// Names as scene files spell them: "seelen", "spiral", and those of schemes that were added. Throws InputError for any
/// other.
SchemeKind schemeFromName(std::string_view name);
/// All of them, in the order of the table.
std::vector<std::string_view> schemeNames();

/// Adds a scheme of rotation of the user's own: from then on scenes and WorldOptions may choose it. Call it once,
/// before anything else reads the table. Throws InputError where the name is empty or taken, a function is missing, or
/// the table is full.
SchemeKind addScheme(const RotationScheme& row);

}  // namespace granular
