// Contacts of the present step on their way into lanes, through a law that works on many at once, and back.
#pragma once

#include <array>

#include "granular/law/contact_lanes.h"
#include "granular/world/world.h"

namespace granular {

/// Large: best kept from call to call.
class LawBatch {
 public:
  /// Empties it for a law and the contacts of a world; dt: of the step, s.
  void begin(double dt, LawInLanes chosen, World::Chunk& into, World& of);
  /// Adds a contact of the chunk that is found and placed. Its force, torques and history are written when the batch is
  /// full or finish() is called, and must stay where they are until then; what it does to its bodies is delivered.
  void add(Contact& contact, ContactHistory& history);
  /// Applies the law to what was added.
  void finish();

 private:
  /// For laws that read curvature.
  void putRadii();

  static constexpr std::size_t capacity = ContactLanes::capacity;

  World* world = nullptr;
  World::Chunk* chunk = nullptr;
  LawInLanes law = nullptr;
  bool manyMaterials = true, elastic = false;
  std::array<Contact*, capacity> contacts{};
  std::array<ContactHistory*, capacity> histories{};
  ContactLanes lanes{};
};

}  // namespace granular
