// Contact laws as pure functions: geometry, velocities, parameters and history in; force, couple and history out.
// Signs: normal from A (i) to B (j); force and couple act on A, their opposites on B.
// A law is one header with an inline kernel (linear.h) and one row of the table in law.cpp, or one that a program adds
// to it (addLaw; examples/extend/cohesive_law.h).
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "granular/pair/history.h"

namespace granular {

struct ContactLanes;

/// Parameters of a pair of materials (S section 6). k_n in N/m; restitution in (0, 1]; friction >= 0.
struct ContactParameters {
  double stiffness = 1e4;     ///< k_n; not read by hertz and hertz_mindlin
  double restitution = 0.8;   ///< e_n; not read by hertz
  double restitutionT = 0.6;  ///< e_t; not read by hertz and hertz_mindlin
  double friction = 0.1;      ///< mu_c
  // Read by hertz and hertz_mindlin alone; setElasticity writes the first two.
  double modulus = 0;       ///< E*: 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b, Pa; 0: not given
  double shearModulus = 0;  ///< G*: 1/G* = (2 - nu_a)/G_a + (2 - nu_b)/G_b, Pa; 0: not given
  double dampingRateN = 0;  ///< hertz: eta_n, 1/s, times the reduced mass
  double dampingRateT = 0;  ///< hertz: eta_t, 1/s
  /// For a law of a user's own, in units of its choice; no law of the library reads them.
  std::array<double, 4> own = {};
};

/// An elastic solid. Isotropic: G = E/(2 (1 + nu)).
struct Elasticity {
  double young = 0;    ///< E, Pa, > 0; infinity: rigid
  double poisson = 0;  ///< nu, in (-1, 0.5]
};
/// Writes E* and G* of two solids. Throws InputError naming value and limit, or if both are rigid.
void setElasticity(const Elasticity& a, const Elasticity& b, ContactParameters& parameters);

/// Named options of the linear law.
struct LawOptions {
  bool tension = true;          ///< keep the attractive end of a damped contact, so that e = e_n (S 10); else cut at 0
  bool frictionOfPush = false;  ///< Coulomb's limit from max(F_n, 0) instead of |F_n|
  bool localMass = false;       ///< contact_mass = local: eta_n from the mass the contact point feels, not from mu
  /// Friction points against the sliding velocity alone (S 9), not against spring and dashpot together. The two agree
  /// wherever a contact slides steadily; a contact at rest at Coulomb's limit flips its force with every sign of u_t
  /// here.
  bool slideAlongVelocity = false;
};

/// A body as a law sees it.
struct ContactBody {
  double inverseMass = 0;              ///< 1/kg; 0 for walls and fixed bodies
  double radiusRatio = 0;              ///< R = <r^2>/<I>, 1/kg; 0 for walls and fixed bodies
  Vec3 arm = Vec3::Zero();             ///< contact point - centre of mass, m
  Mat3 inverseInertia = Mat3::Zero();  ///< world axes, 1/(kg m^2); filled if lawReadsInertia
};

/// Kinematics of one contact at t_n. Velocities handed to dashpots are those at t_n; the increment of the tangential
/// spring is the half-step velocity times dt.
struct ContactMotion {
  Vec3 normal;              ///< unit, A to B
  double overlap = 0;       ///< what the elastic force is k_n times of, m
  double squaredDepth = 0;  ///< what the elastic energy is k_n/2 times of, m^2; accounts and Hertz's laws read it
  Vec3 velocity;            ///< of A's contact point minus B's at t_n, at `point`
  Vec3 slip;                ///< relative displacement of the contact point during the last step, m
  Vec3 spin;                ///< w_A - w_B at t_n, rad/s; read only for a patch
  Vec3 meanSpin;            ///< (w_A + w_B)/2, rad/s: turns the spring about the normal
  double share = 1;         ///< factor on stiffness and dashpots, for a spot among those of one face
  double radius = 0;        ///< effective radius of the two surfaces, m; read if lawReadsCurvature
  double dt = 0;
  // Patch: zero area for a point contact.
  Vec3 centreArm;  ///< patch centre - contact point, m
  double area = 0;
  Vec3 u;  ///< in-plane axis of the moments
  double uu = 0, vv = 0, uv = 0;
  double rocking = 1;        ///< factor on the normal dashpot's moments
  Vec3 turn = Vec3::Zero();  ///< relative rotation during the last step: (w_A - w_B) at the half step times dt, rad
};

enum class LawKind : unsigned char {
  linear,       ///< S: one normal and one tangential spring, the latter from averaged masses
  linearLocal,  ///< the same springs, from the masses that the contact point feels
  tensor,       ///< a stiffness matrix that makes normal and tangential motion isochronous
  hertz,        ///< Hertz's force with the damping and the tangential spring of Markauskas et al. 2010
  hertzMindlin  ///< Hertz's force with a restitution, Mindlin's tangential stiffness by increments
};

/// Constants of a parameter set that every contact of the pair of materials shares: all logarithms and roots of the
/// law. The index of the two-valued ones is LawOptions::tension: 0 cut at 0, 1 attractive end kept.
struct LawConstants {
  ContactParameters parameters;
  double inverseStiffness = 0;  ///< 1/k_n, m/N
  double dampingN[2] = {};      ///< 2 zeta: eta_n = dampingN sqrt(k_n m) (S 15, or the cut-off formula)
  double timeFactor[2] = {};    ///< t_c = timeFactor sqrt(m/k_n) (S 14, or the cut-off formula)
  double dampingT = 0;          ///< eta_t = dampingT m_t sqrt(k_n/mu) (S 16)
  double stiffnessRatio = 0;    ///< (pi^2 + ln^2 e_t)/(pi^2 + ln^2 e_n) (S 13)
  double hertz = 0;             ///< 4/3 E*, Pa
  double mindlin = 0;           ///< 8 G*, Pa
};

/// Checks the parameters and prepares their constants. Throws InputError naming parameter, value and limit when a value
/// is not finite, stiffness <= 0, a restitution is outside (0, 1] (e = 0 has no finite dashpot), friction, a modulus or
/// a damping rate < 0. `own` may have either sign.
LawConstants prepareLaw(const ContactParameters& parameters);

/// Damping ratio zeta of a linear dashpot whose restitution is e in (0, 1]: with the attractive end kept, or cut at 0.
double dampingRatioFor(double restitution, bool tension);

using Law = void (*)(const LawConstants&, const LawOptions&, const ContactBody& a, const ContactBody& b,
                     const ContactMotion&, ContactHistory&, ContactForce&);
/// The table of laws; one row per law.
Law lawFunction(LawKind kind);
/// The same law of contacts side by side, to the same bits (contact_lanes.h).
using LawInLanes = void (*)(const LawOptions&, ContactLanes&);
/// Null for a law, or for options, that go one by one only.
LawInLanes lawInLanes(LawKind kind, const LawOptions& options);
/// Names as scene files spell them: "linear", "linear_local", "tensor", "hertz", "hertz_mindlin", and those of laws
/// that were added. Throws InputError for any other.
LawKind lawFromName(std::string_view name);
std::string_view lawName(LawKind kind);
/// All of them, in the order of the table.
std::vector<std::string_view> lawNames();
/// True if the law reads ContactBody::inverseInertia.
bool lawReadsInertia(LawKind kind, const LawOptions& options);
/// True if the law reads ContactMotion::radius, and the elastic constants of its pair.
bool lawReadsCurvature(LawKind kind);
/// True if only stiffnessOf knows how stiff a contact is; else its normal stiffness is k_n at every overlap.
bool lawSetsStiffness(LawKind kind);
/// False for a law that was added without an account: no energy ledger can be kept with it.
bool lawKeepsAccount(LawKind kind);

/// What a law did with energy in one step, for the energy ledger. Springs as at t_n, after the law.
struct ContactAccount {
  double normalSpring = 0;      ///< elastic energy of the overlap while nothing holds the contact sideways, J
  double tangentialSpring = 0;  ///< the rest of it: tangential spring and a patch's torsion, J
  Vec3 elasticForce = Vec3::Zero(), elasticCouple = Vec3::Zero();  ///< the springs' part of force and couple on A
  Vec3 dampingForce = Vec3::Zero(), dampingCouple = Vec3::Zero();  ///< the normal dashpot's
  Vec3 viscousForce = Vec3::Zero(), viscousCouple = Vec3::Zero();  ///< all the rest: tangential dashpots, or friction
  double slipHeat = 0;  ///< friction heat of the springs that gave way since t_{n-1}, J
  bool slides = false;  ///< viscousForce and
  bool twists = false;  ///< viscousCouple belong to friction
};
/// The account of one application of the law: before and after are the contact's history then, force what it answered.
ContactAccount accountContact(LawKind kind, const LawConstants&, const LawOptions&, const ContactBody& a,
                              const ContactBody& b, const ContactMotion&, const ContactHistory& before,
                              const ContactHistory& after, const ContactForce& force);

/// Effective coefficients of one contact, for the bound on the time step (S 13-16). tensor: the diagonal of its
/// matrices. hertz, hertz_mindlin: of small motions about the overlap, dF/d(overlap) in the normal direction; the time
/// is that of an elastic impact that reaches it.
struct ContactStiffness {
  double normal = 0, tangential = 0;                ///< N/m
  double dampingNormal = 0, dampingTangential = 0;  ///< kg/s
  double contactTime = 0;                           ///< t_c, s
};
/// At least one body must be free. overlap and effective radius, m: read by hertz and hertz_mindlin.
ContactStiffness stiffnessOf(LawKind kind, const LawConstants&, const LawOptions&, const ContactBody& a,
                             const ContactBody& b, const Vec3& normal, double overlap = 0, double radius = 0);

using StiffnessFinder = ContactStiffness (*)(const LawConstants&, const LawOptions&, const ContactBody& a,
                                             const ContactBody& b, const Vec3& normal, double overlap, double radius);
struct SpringStep;
/// Writes springs, elastic force and slip heat of an account; what is left of the force counts as the dashpots'.
using Accountant = void (*)(const LawConstants&, const LawOptions&, const ContactBody& a, const ContactBody& b,
                            const ContactMotion&, const SpringStep&, ContactAccount&);

/// One row of the table of laws.
struct LawRow {
  std::string_view name;                ///< as scene files spell it; a literal
  Law apply = nullptr;                  ///< thread-safe, depends on its arguments alone
  StiffnessFinder stiffness = nullptr;  ///< stiffnessOf, from which the bound on the time step comes
  Accountant account = nullptr;         ///< for the energy ledger (law/account.h); null: none can be kept
  bool readsInertia = false;            ///< ContactBody::inverseInertia
  bool readsCurvature = false;          ///< ContactMotion::radius and the elastic constants of the pair
  /// What the law does to the history before it looks at it; null: nothing.
  void (*prepare)(const ContactMotion&, ContactHistory&) = nullptr;
  LawInLanes inLanes = nullptr;  ///< many contacts at once, unless inertia is read; null: one by one only
};

/// Adds a law of the user's own: from then on scenes and WorldOptions may choose it. In scenes it has the keys of
/// `linear`, or those of `hertz_mindlin` if it reads curvature. Call it once, before anything else reads the table.
/// Throws InputError where the name is empty or taken, apply or stiffness is missing, or the table is full.
LawKind addLaw(const LawRow& row);

}  // namespace granular
