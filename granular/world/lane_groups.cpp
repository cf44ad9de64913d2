#include "granular/world/lane_groups.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

}  // namespace

void keepTouching(const std::size_t* positions, std::size_t count, World& world, World::Chunk& chunk) {
  const auto sizeOf = [&](std::int32_t body) { return body < 0 ? infinity : world.bodies.shape[at(body)]->size(); };
  chunk.deepest = 0;
  // Those that stay move towards the front a run at a time.
  const auto contacts = chunk.contacts.begin();
  std::int32_t kept = 0, run = 0;
  const auto moveRun = [&](std::int32_t end) {
    const std::int32_t to = kept - (end - run);
    if (to != run) std::copy(contacts + run, contacts + end, contacts + to);
    run = end + 1;
  };
  for (std::size_t p = 0; p < count; ++p) {
    World::ContactRange& range = world.contactsOfPair[positions[p]];
    const std::int32_t before = kept;
    for (std::int32_t k = range.first; k < range.first + range.count; ++k) {
      const Contact& contact = chunk.contacts[at(k)];
      if (contact.a < 0) {
        moveRun(k);
        continue;
      }
      chunk.noteDepth(contact.touch.overlap, std::min(sizeOf(contact.a), sizeOf(contact.b)), at(kept));
      ++kept;
    }
    range = {before, kept - before};
  }
  moveRun(static_cast<std::int32_t>(chunk.contacts.size()));
  chunk.contacts.resize(at(kept));
}

}  // namespace granular
