// Contacts of smooth bodies on their way through the law, side by side and in short (BriefContact): what batches of
// balls and of ellipsoids share. Where they touch is for those to say.
#pragma once

#include <array>

#include "granular/law/contact_lanes.h"
#include "granular/world/world.h"

namespace granular {

/// A thread's own: large, and kept from call to call.
template <class Thing>
Thing& ownOfThread() {
  thread_local Thing thing{};
  return thing;
}

struct BriefBatch {
  static constexpr std::size_t capacity = ContactLanes::capacity;

  std::array<std::int32_t, capacity> pair, a, b, childA, childB;  ///< as in BriefContact; body slots
  std::array<ContactHistory*, capacity> history;
  ContactLanes contacts;  ///< for the law, where normal, overlap, squaredDepth, radius and arms are still missing

  std::size_t count() const { return contacts.count; }
  /// Empties it for the contacts of a world; dt: of the step, s.
  void begin(double dt, const World& of);
  /// Adds a contact: returns its lane. memory is read and written by press().
  struct Who {
    std::int32_t pair, a, b, childA, childB;
  };
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
  /// Where the contacts of the register from lane k on touch; x: the bodies' centres of mass, shift: of B's image, m.
  struct Where {
    Triple<Wide> normal;
    Wide overlap;
    Triple<Wide> middle;
  };
  void place(std::size_t k, const Where& where, const Triple<Wide>& xA, const Triple<Wide>& xB,
             const Triple<Wide>& shift) {
    // The arithmetic of Touch::placeAbout and placeWitness.
    const Triple<Wide> half = Wide(0.5 * where.overlap) * where.normal;
    const Triple<Wide> point = 0.5 * (where.middle + half + (where.middle - half));
    contacts.normal.store(k, where.normal);
    contacts.overlap.store(k, where.overlap);
    contacts.squaredDepth.store(k, where.overlap * where.overlap);
    contacts.a.arm.store(k, point - xA);
    contacts.b.arm.store(k, point - xB - shift);
  }
  /// Lane `to` becomes lane `from`.
  void move(std::size_t from, std::size_t to);
  /// Fills the lanes beyond the last contact of its register with that contact: they take part in loading whole
  /// registers, and in nothing else.
  void fillRegister();
  /// The law for all contacts: histories are kept, contacts and their pulls appended to the chunk.
  void press(World::Chunk& chunk);

 private:
  void load();
  void store(World::Chunk& chunk) const;
  void putConstants(std::size_t k, std::int32_t materialA, std::int32_t materialB);

  const World* world = nullptr;
  LawInLanes law = nullptr;
  bool manyMaterials = true;
};

}  // namespace granular
