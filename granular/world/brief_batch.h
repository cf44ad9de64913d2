// Contacts of smooth bodies on their way through the law, side by side and in short (BriefContact): what batches of
// balls and of ellipsoids share. Where they touch is for those to say.
#pragma once

#include <array>

#include "granular/core/share_out.h"
#include "granular/law/contact_lanes.h"
#include "granular/world/world.h"

namespace granular {

/// A batch of contacts.
struct BriefBatch {
  static constexpr std::size_t capacity = ContactLanes::capacity;

  std::array<std::int32_t, capacity> pair, a, b, childA, childB;  ///< as in BriefContact; body slots
  std::array<std::size_t, capacity> due;                          ///< which of the chunk's due pairs: for dropApart()
  std::array<ContactHistory*, capacity> history;
  ContactLanes::Lanes shift, middle;  ///< of B's image; halfway between the surfaces, m
  ContactLanes contacts;  ///< for the law, where normal, overlap, squaredDepth, radius and arms are still missing

  std::size_t count() const { return contacts.count; }
  /// Empties it for the contacts of a world; dt: of the step, s.
  void begin(double dt, World& of);
  /// Who touch: as in BriefContact; body slots.
  struct Who {
    std::int32_t pair, a, b, childA, childB;
  };
  /// Adds a contact: returns its lane. memory is read and written by press().
  std::size_t add(const Who& who, ContactHistory& memory) {
    const std::size_t k = contacts.count++;
    pair[k] = who.pair;
    a[k] = who.a;
    b[k] = who.b;
    childA[k] = who.childA;
    childB[k] = who.childB;
    history[k] = &memory;
    return k;
  }
  /// SmoothTouch of the contacts in a register.
  struct Where {
    Triple<Wide> normal;
    Wide overlap;
    Triple<Wide> middle;
  };
  /// Where the contacts of the register from lane k on touch; x: the bodies' centres of mass, m.
  void place(std::size_t k, const Where& where, const Triple<Wide>& xA, const Triple<Wide>& xB) {
    // The arithmetic of Touch::placeAbout and placeWitness.
    const Triple<Wide> half = Wide(0.5 * where.overlap) * where.normal;
    const Triple<Wide> point = 0.5 * (where.middle + half + (where.middle - half));
    contacts.normal.store(k, where.normal);
    contacts.overlap.store(k, where.overlap);
    contacts.squaredDepth.store(k, where.overlap * where.overlap);
    contacts.a.arm.store(k, point - xA);
    contacts.b.arm.store(k, point - xB - shift.load(k));
    middle.store(k, where.middle);
  }
  /// Fills the lanes beyond the last contact of its register with that contact: they take part in loading whole
  /// registers, and in nothing else.
  void fillRegister();
  /// Takes out those whose overlap is not above 0, which are the only ones of their pairs, and names these in
  /// Due::apart; the deepest of the others is noted. size: what overlaps are relative to, m.
  void dropApart(const ContactLanes::Lane& size, World::Chunk& chunk);
  /// The law for all contacts: histories are kept, contacts appended to the chunk, and what they do to their bodies is
  /// delivered.
  void press(World::Chunk& chunk);

 private:
  void move(std::size_t from, std::size_t to);
  void load();
  void store(World::Chunk& chunk) const;
  void addToBodies(World::Chunk& chunk) const;
  void putConstants(std::size_t k, std::int32_t materialA, std::int32_t materialB);

  World* world = nullptr;
  LawInLanes law = nullptr;
  bool manyMaterials = true;
};

}  // namespace granular
