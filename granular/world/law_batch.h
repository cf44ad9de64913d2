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
  void begin(double dt, LawInLanes chosen, World& of);
  /// Adds a contact that is found and placed. Its force and torques, history and pull are written when the batch is
  /// full or finish() is called, and must stay where they are until then. pull: null if World::addsAtOnce.
  void add(Contact& contact, ContactHistory& history, ContactPull* pull);
  /// Applies the law to what was added.
  void finish();

 private:
  /// For laws that read curvature.
  void putRadii();
  void addToBodies();
  void takePulls();

  static constexpr std::size_t capacity = ContactLanes::capacity;

  World* world = nullptr;
  LawInLanes law = nullptr;
  bool manyMaterials = true, elastic = false;
  std::array<Contact*, capacity> contacts{};
  std::array<ContactHistory*, capacity> histories{};
  std::array<ContactPull*, capacity> pulls{};
  ContactLanes lanes{};
};

}  // namespace granular
