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
  void begin(double dt, LawInLanes chosen, const World& of);
  /// Adds a contact that is found and placed. Its force and torques, history and pull are written when the batch is
  /// full or finish() is called, and must stay where they are until then.
  void add(Contact& contact, ContactHistory& history, ContactPull& pull);
  /// Applies the law to what was added.
  void finish();

 private:
  struct Item {
    Contact* contact;
    ContactHistory* history;
    ContactPull* pull;
  };

  const World* world = nullptr;
  LawInLanes law = nullptr;
  std::array<Item, ContactLanes::capacity> items{};
  ContactLanes lanes{};
};

}  // namespace granular
