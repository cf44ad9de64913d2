// One contact of the present step: what was found, where it acts, what came of it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "granular/pair/contact_patch.h"
#include "granular/pair/history.h"
#include "granular/pair/spot.h"
#include "granular/pair/touch.h"

namespace granular {

struct Contact {
  std::int32_t pair = -1;       ///< index in PairList::pairs, or in wallPairs for walls
  std::int32_t a = -1, b = -1;  ///< body slots; b = -1 - wall for walls
  Spot spot;                    ///< which contact of the pair
  double share = 1;             ///< of the stiffness, among the spots of one face
  Vec3 shift;                   ///< B's image minus its stored position, m
  Touch touch;
  ContactPatch patch;
  ContactForce force;
  bool placed = false;    ///< the patch is made, together with the touch
  bool held = false;      ///< of two bodies at rest: kept from the step in which they came to rest
  Vec3 torqueA, torqueB;  ///< about either centre of mass, N m
};
static_assert(offsetof(ContactForce, normalForce) == 6 * sizeof(double));                      // rows of
static_assert(offsetof(Contact, torqueB) == offsetof(Contact, torqueA) + 3 * sizeof(double));  // numbers

/// What a contact does to its bodies: all that the sum of forces reads, apart from what describes the contact.
struct ContactPull {
  std::int32_t a, b;      ///< as in Contact
  Vec3 force;             ///< on A, N
  Vec3 torqueA, torqueB;  ///< about either centre of mass, N m
};
inline ContactPull pullOf(const Contact& contact) {
  return {contact.a, contact.b, contact.force.force, contact.torqueA, contact.torqueB};
}

/// A contact of two smooth bodies or children in short; the rest of a Contact follows from where the two touch, which
/// balls tell at any time and a SmoothTouch remembers for others.
struct BriefContact {
  Vec3 force;  ///< as in ContactForce
  double normalForce;
  std::int32_t pair;  ///< index in PairList::pairs
  bool sliding, held;
};
static_assert(offsetof(BriefContact, normalForce) == 3 * sizeof(double));  // a row of numbers

}  // namespace granular
