// Contact laws as pure functions: geometry, velocities, parameters and history in; force, couple and history out.
// Signs: normal from A (i) to B (j); force and couple act on A, their opposites on B.
#pragma once

#include <string_view>

#include "granular/pair/history.h"

namespace granular {

/// Parameters of a pair of materials (S section 6). k_n in N/m; restitution in (0, 1]; friction >= 0.
struct ContactParameters {
  double stiffness = 1e4;      ///< k_n
  double restitution = 0.8;    ///< e_n
  double restitutionT = 0.6;   ///< e_t
  double friction = 0.1;       ///< mu_c
};

/// Named options of the linear law.
struct LawOptions {
  bool tension = true;          ///< keep the attractive end of a damped contact, so that e = e_n (S 10); else cut at 0
  bool frictionOfPush = false;  ///< Coulomb's limit from max(F_n, 0) instead of |F_n|
  bool localMass = false;       ///< contact_mass = local: damping from the mass the contact point feels, not from mu
};

/// A body as a law sees it.
struct ContactBody {
  double inverseMass = 0;       ///< 1/kg; 0 for walls and fixed bodies
  double radiusRatio = 0;       ///< R = <r^2>/<I>, 1/kg; 0 for walls and fixed bodies
  Vec3 arm = Vec3::Zero();      ///< contact point - centre of mass, m
  Mat3 inverseInertia = Mat3::Zero();  ///< world axes, 1/(kg m^2); read only with localMass
};

/// Kinematics of one contact at t_n. Velocities handed to dashpots are those at t_n; the increment of the tangential spring is
/// the half-step velocity times dt (design 1.3).
struct ContactMotion {
  Vec3 normal;             ///< unit, A to B
  double overlap = 0;      ///< m
  Vec3 velocity;           ///< of A's contact point minus B's at t_n, at `point`
  Vec3 slip;               ///< relative displacement of the contact point during the last step, m
  Vec3 spin;               ///< w_A - w_B at t_n, rad/s
  Vec3 meanSpin;           ///< (w_A + w_B)/2, rad/s: turns the spring about the normal
  double share = 1;        ///< stiffness share of this spot among the spots of one face
  double dt = 0;
  // Patch: zero area for a point contact.
  Vec3 centreArm;          ///< patch centre - contact point, m
  double area = 0;
  Vec3 u;                  ///< in-plane axis of the moments
  double uu = 0, vv = 0, uv = 0;
};

enum class LawKind : unsigned char { linear };

/// Constants of a parameter set that every contact of the pair of materials shares.
struct LawConstants {
  ContactParameters parameters;
  double logN = 0, logT = 0;      ///< ln e_n, ln e_t
  double phase = 0;               ///< pi^2 + ln^2 e_n
  double stiffnessRatio = 0;      ///< (pi^2 + ln^2 e_t)/(pi^2 + ln^2 e_n)
  double dampingRatioCut = 0;     ///< zeta for e_n when the force is cut at 0 (verification c)
};
LawConstants prepareLaw(const ContactParameters& parameters);

using Law = void (*)(const LawConstants&, const LawOptions&, const ContactBody& a, const ContactBody& b,
                     const ContactMotion&, ContactHistory&, ContactForce&);
/// The table of laws; one row per law.
Law lawFunction(LawKind kind);
LawKind lawFromName(std::string_view name);

/// Effective coefficients of one contact, for the bound on the time step (S 13-16; design 1.3).
struct ContactStiffness {
  double normal = 0, tangential = 0;         ///< N/m
  double dampingNormal = 0, dampingTangential = 0;  ///< kg/s
  double contactTime = 0;                    ///< t_c, s
};
ContactStiffness stiffnessOf(const LawConstants&, const LawOptions&, const ContactBody& a, const ContactBody& b,
                             const Vec3& normal);

}  // namespace granular
