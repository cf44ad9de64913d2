#include "granular/world/lane_groups.h"

namespace granular {
namespace {

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

}  // namespace

void keepTouching(const std::uint16_t* dueOf, const World& world, World::Chunk& chunk) {
  const auto sizeOf = [&](std::int32_t body) { return body < 0 ? infinity : world.bodies.shape[at(body)]->size(); };
  chunk.deepest = 0;
  // Those that stay move towards the front a run at a time.
  const auto contacts = chunk.contacts.begin();
  const auto count = static_cast<std::int32_t>(chunk.contacts.size());
  std::int32_t kept = 0, run = 0;
  const auto moveRun = [&](std::int32_t end) {
    const std::int32_t to = kept - (end - run);
    if (to != run) std::copy(contacts + run, contacts + end, contacts + to);
    run = end + 1;
  };
  for (std::int32_t k = 0; k < count; ++k) {
    const Contact& contact = chunk.contacts[at(k)];
    if (contact.a < 0) {
      moveRun(k);
      if (dueOf) chunk.due.apart.set(dueOf[k]);
      continue;
    }
    chunk.noteDepth(contact.touch.overlap, std::min(sizeOf(contact.a), sizeOf(contact.b)), at(kept));
    ++kept;
  }
  moveRun(count);
  chunk.contacts.resize(at(kept));
}

}  // namespace granular
