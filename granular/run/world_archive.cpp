#include "granular/run/world_archive.h"

#include "granular/run/packing_run.h"
#include "granular/world/stages.h"

namespace granular {

template <>
struct Element<BodyState> {
  static constexpr ElementType type = ElementType::uint8;
  static constexpr std::uint64_t width = 1;
};

/// As bytes: single-precision numbers.
template <>
struct Element<KeptProof> {
  static constexpr ElementType type = ElementType::uint8;
  static constexpr std::uint64_t width = sizeof(KeptProof);
};

namespace {

/// A column made of one field of every row; field(row) returns a reference. Rows must have their final number.
template <class T, class Row, class Field>
void visitField(Archive& archive, std::string_view name, std::vector<Row>& rows, Field field) {
  std::vector<T> column;
  column.reserve(rows.size());
  for (Row& row : rows) column.push_back(static_cast<T>(field(row)));
  archive.visit(name, column);
  if (!archive.loading()) return;
  require(column.size() == rows.size(),
          "checkpoint: column " + std::string(name) + " is of another length than its neighbours");
  for (std::size_t k = 0; k < rows.size(); ++k)
    field(rows[k]) = static_cast<std::decay_t<decltype(field(rows[k]))>>(column[k]);
}

/// The number of rows, which loading gives to the list.
template <class Row>
void visitCount(Archive& archive, std::vector<Row>& rows) {
  auto count = static_cast<std::uint64_t>(rows.size());
  archive.visit("count", count);
  rows.resize(count);
}

void visitHistory(Archive& archive, std::vector<ContactHistory>& rows) {
  archive.visitMember("spring", rows, &ContactHistory::spring, {"m", "tangential spring, world axes"});
  archive.visitMember("normal", rows, &ContactHistory::normal, {"", "normal of the last step; zero: no contact"});
  archive.visitMember("twist", rows, &ContactHistory::twist, {"rad", "torsional spring"});
}

void visitContacts(Archive& archive, std::vector<Contact>& rows) {
  visitCount(archive, rows);
  visitField<std::int32_t>(
      archive, "pair", rows, [](Contact & c) -> auto& { return c.pair; });
  visitField<std::int32_t>(
      archive, "a", rows, [](Contact & c) -> auto& { return c.a; });
  visitField<std::int32_t>(
      archive, "b", rows, [](Contact & c) -> auto& { return c.b; });
  visitField<std::int32_t>(
      archive, "spot", rows, [](Contact & c) -> auto& { return c.spot.number; });
  visitField<std::int32_t>(
      archive, "child_a", rows, [](Contact & c) -> auto& { return c.spot.childA; });
  visitField<std::int32_t>(
      archive, "child_b", rows, [](Contact & c) -> auto& { return c.spot.childB; });
  visitField<double>(
      archive, "share", rows, [](Contact & c) -> auto& { return c.share; });
  visitField<Vec3>(
      archive, "shift", rows, [](Contact & c) -> auto& { return c.shift; });
  visitField<Vec3>(
      archive, "normal", rows, [](Contact & c) -> auto& { return c.touch.normal; });
  visitField<double>(
      archive, "overlap", rows, [](Contact & c) -> auto& { return c.touch.overlap; });
  visitField<Vec3>(
      archive, "on_a", rows, [](Contact & c) -> auto& { return c.touch.onA; });
  visitField<Vec3>(
      archive, "on_b", rows, [](Contact & c) -> auto& { return c.touch.onB; });
  visitField<Vec3>(
      archive, "point", rows, [](Contact & c) -> auto& { return c.patch.point; });
  visitField<Vec3>(
      archive, "centre", rows, [](Contact & c) -> auto& { return c.patch.centre; });
  visitField<double>(
      archive, "area", rows, [](Contact & c) -> auto& { return c.patch.area; });
  visitField<Vec3>(
      archive, "u", rows, [](Contact & c) -> auto& { return c.patch.u; });
  visitField<double>(
      archive, "uu", rows, [](Contact & c) -> auto& { return c.patch.uu; });
  visitField<double>(
      archive, "vv", rows, [](Contact & c) -> auto& { return c.patch.vv; });
  visitField<double>(
      archive, "uv", rows, [](Contact & c) -> auto& { return c.patch.uv; });
  visitField<Vec3>(
      archive, "force", rows, [](Contact & c) -> auto& { return c.force.force; });
  visitField<Vec3>(
      archive, "couple", rows, [](Contact & c) -> auto& { return c.force.couple; });
  visitField<double>(
      archive, "normal_force", rows, [](Contact & c) -> auto& { return c.force.normalForce; });
  visitField<std::uint8_t>(
      archive, "sliding", rows, [](Contact & c) -> auto& { return c.force.sliding; });
  visitField<std::uint8_t>(
      archive, "held", rows, [](Contact & c) -> auto& { return c.held; });
  visitField<Vec3>(
      archive, "torque_a", rows, [](Contact & c) -> auto& { return c.torqueA; });
  visitField<Vec3>(
      archive, "torque_b", rows, [](Contact & c) -> auto& { return c.torqueB; });
}

void visitEnergies(Archive& archive, std::vector<SpringEnergy>& rows) {
  archive.inGroup("springs", [&] {
    archive.visitMember("normal", rows, &SpringEnergy::normal, {"J", "for the energy ledger"});
    archive.visitMember("tangential", rows, &SpringEnergy::tangential, {"J", ""});
    archive.visitMember("step", rows, &SpringEnergy::step);
  });
}

/// Lists of spots per row: how many each has, then all in one column.
template <class Row>
void visitSpots(Archive& archive, std::vector<Row>& rows) {
  std::vector<std::int32_t> counts;
  std::vector<Spot> spots;
  std::vector<ContactHistory> histories;
  std::vector<SpringEnergy> energies;
  for (const Row& row : rows) {
    counts.push_back(static_cast<std::int32_t>(row.spots.size()));
    for (const SpotHistory& spot : row.spots) {
      spots.push_back(spot.spot);
      histories.push_back(spot.history);
      energies.push_back(spot.energy);
    }
  }
  archive.visit("spot_count", counts);
  archive.visitMember("spot", spots, &Spot::number, {"", "which contact of the pair"});
  archive.visitMember("child_a", spots, &Spot::childA, {"", "of a clump; -1: none"});
  archive.visitMember("child_b", spots, &Spot::childB);
  visitHistory(archive, histories);
  visitEnergies(archive, energies);
  if (!archive.loading()) return;
  std::size_t next = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::int32_t n = 0; n < counts[k]; ++n, ++next)
      rows[k].spots.push_back({spots[next], histories[next], energies[next]});
  }
}

void visitManifolds(Archive& archive, std::vector<ManifoldMemory>& rows) {
  visitCount(archive, rows);
  visitField<std::int32_t>(
      archive, "points", rows, [](ManifoldMemory & m) -> auto& { return m.manifold.count; });
  visitField<std::int32_t>(
      archive, "next_spot", rows, [](ManifoldMemory & m) -> auto& { return m.manifold.nextSpot; });
  for (std::size_t k = 0; k < 4; ++k) {
    archive.inGroup("point_" + std::to_string(k), [&] {
      visitField<Vec3>(
          archive, "on_a", rows, [k](ManifoldMemory & m) -> auto& { return m.manifold.points[k].onA; });
      visitField<Vec3>(
          archive, "on_b", rows, [k](ManifoldMemory & m) -> auto& { return m.manifold.points[k].onB; });
      visitField<Vec3>(
          archive, "normal", rows, [k](ManifoldMemory & m) -> auto& { return m.manifold.points[k].normal; });
      visitField<double>(
          archive, "overlap", rows, [k](ManifoldMemory & m) -> auto& { return m.manifold.points[k].overlap; });
      visitField<std::int32_t>(
          archive, "spot", rows, [k](ManifoldMemory & m) -> auto& { return m.manifold.points[k].spot; });
      visitField<std::int32_t>(
          archive, "age", rows, [k](ManifoldMemory & m) -> auto& { return m.manifold.points[k].age; });
    });
  }
  visitSpots(archive, rows);
}

/// Lists of a clump's near children: how many each has, then all in one column.
template <class Row>
void visitChildren(Archive& archive, std::vector<Row>& rows) {
  visitField<double>(
      archive, "children_until", rows, [](Row & r) -> auto& { return r.children.validUntil; });
  std::vector<std::int32_t> counts;
  std::vector<ChildPair> all;
  for (const Row& row : rows) {
    counts.push_back(static_cast<std::int32_t>(row.children.near.size()));
    all.insert(all.end(), row.children.near.begin(), row.children.near.end());
  }
  archive.visit("children_count", counts, {"", "children near each other"});
  archive.inGroup("children", [&] {
    archive.visitMember("a", all, &ChildPair::childA);
    archive.visitMember("b", all, &ChildPair::childB);
    archive.visitMember("quiet_until", all, &ChildPair::quietUntil,
                        {"m", "sum of travels before which they can't touch"});
  });
  if (!archive.loading()) return;
  std::size_t next = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::int32_t n = 0; n < counts[k]; ++n) rows[k].children.near.push_back(all[next++]);
  }
}

void visitCaches(Archive& archive, std::vector<WarmCache>& caches) {
  archive.visitMember("kind", caches, &WarmCache::kind, {"", "what the warm start verifies"});
  archive.visitMember("feature_a", caches, &WarmCache::featureA);
  archive.visitMember("feature_b", caches, &WarmCache::featureB);
  archive.visitMember("touched", caches, &WarmCache::touched);
  archive.visitMember("direction", caches, &WarmCache::direction);
  archive.visitMember("budget", caches, &WarmCache::budget, {"m", ""});
  archive.visitMember("proof", caches, &WarmCache::proof, {"", "proof kept from an earlier step, float32"});
}

void visitClumps(Archive& archive, std::vector<ClumpMemory>& rows) {
  visitCount(archive, rows);
  visitChildren(archive, rows);
  visitSpots(archive, rows);
  std::vector<std::int32_t> counts, heldCounts;
  std::vector<WarmCache> caches;
  std::vector<Contact> held;
  for (const ClumpMemory& row : rows) {
    counts.push_back(static_cast<std::int32_t>(row.caches.size()));
    caches.insert(caches.end(), row.caches.begin(), row.caches.end());
    heldCounts.push_back(static_cast<std::int32_t>(row.held.size()));
    held.insert(held.end(), row.held.begin(), row.held.end());
  }
  archive.visit("cache_count", counts);
  archive.inGroup("caches", [&] { visitCaches(archive, caches); });
  archive.visit("held_count", heldCounts);
  archive.inGroup("held", [&] { visitContacts(archive, held); });
  if (!archive.loading()) return;
  std::size_t nextCache = 0, nextHeld = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::int32_t n = 0; n < counts[k]; ++n) rows[k].caches.push_back(caches[nextCache++]);
    for (std::int32_t n = 0; n < heldCounts[k]; ++n) rows[k].held.push_back(held[nextHeld++]);
  }
}

void visitPairs(Archive& archive, PairList& list) {
  archive.inGroup("pairs", [&] {
    archive.visitMember("a", list.pairs, &Pair::a, {"", "slot of the body of lower id"});
    archive.visitMember("b", list.pairs, &Pair::b);
    archive.visitMember("slot", list.pairs, &Pair::slot, {"", "row of memory"});
    archive.visitMember("image", list.pairs, &Pair::image, {"", "periods to b's image"});
    archive.visitMember("quiet_until", list.pairs, &Pair::quietUntil,
                        {"m", "sum of travels before which it can't touch"});
  });
  archive.inGroup("memory", [&] {
    PairMemory& memory = list.memory;
    visitHistory(archive, memory.history);
    visitCaches(archive, memory.cache);
    visitEnergies(archive, memory.energy);
    archive.visit("free", memory.free);
    archive.inGroup("held", [&] { visitContacts(archive, memory.held); });
    archive.inGroup("manifolds", [&] { visitManifolds(archive, memory.manifolds); });
    archive.inGroup("clumps", [&] { visitClumps(archive, memory.clumps); });
  });
}

void visitWallPairs(Archive& archive, std::vector<WallPair>& pairs) {
  archive.inGroup("wall_pairs", [&] {
    visitCount(archive, pairs);
    visitField<std::int32_t>(
        archive, "body", pairs, [](WallPair & p) -> auto& { return p.body; });
    visitField<std::int32_t>(
        archive, "wall", pairs, [](WallPair & p) -> auto& { return p.wall; });
    visitField<double>(
        archive, "quiet_until", pairs, [](WallPair & p) -> auto& { return p.quietUntil; });

    visitSpots(archive, pairs);
    visitChildren(archive, pairs);

    // Contacts of bodies at rest: how many each pair has, then all in one list.
    std::vector<std::int32_t> heldCount;
    std::vector<Contact> held;
    for (const WallPair& pair : pairs) {
      heldCount.push_back(static_cast<std::int32_t>(pair.held.size()));
      held.insert(held.end(), pair.held.begin(), pair.held.end());
    }
    archive.visit("held_count", heldCount);
    archive.inGroup("held", [&] { visitContacts(archive, held); });
    if (!archive.loading()) return;
    std::size_t next = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      for (std::int32_t n = 0; n < heldCount[k]; ++n) pairs[k].held.push_back(held[next++]);
    }
  });
}

void visitTroubles(Archive& archive, std::vector<Trouble>& troubles) {
  archive.inGroup("troubles", [&] {
    archive.visitMember("time", troubles, &Trouble::time, {"s", ""});
    visitField<std::uint8_t>(
        archive, "kind", troubles, [](Trouble & t) -> auto& { return t.kind; });
    archive.visitMember("body_a", troubles, &Trouble::bodyA);
    archive.visitMember("body_b", troubles, &Trouble::bodyB);
    archive.visitMember("value", troubles, &Trouble::value, {"", "overlap over size, or speed in m/s"});
    std::vector<std::string> walls;
    for (const Trouble& trouble : troubles) walls.push_back(trouble.wall);
    archive.visit("wall", walls, {"", "name; empty: none"});
    require(walls.size() == troubles.size(), "checkpoint: column wall is of another length than its neighbours");
    for (std::size_t k = 0; k < troubles.size(); ++k) troubles[k].wall = walls[k];
  });
}

void visitReport(Archive& archive, Report& report) {
  archive.inGroup("report", [&] {
    NarrowCounts& narrow = report.narrow;
    archive.visit("cold", narrow.cold);
    archive.visit("searches", narrow.searches);
    archive.visit("warm", narrow.warm);
    archive.visit("uncertified", narrow.uncertified);
    archive.visit("coarse", narrow.coarse);
    archive.visit("fallbacks", narrow.fallbacks);
    archive.visit("missed", narrow.missed);
    archive.visit("normal_flips", narrow.normalFlips);
    archive.visit("deepest_overlap", report.deepestOverlap, {"", "over size"});
    archive.visit("deepest_time", report.deepestTime, {"s", ""});
    archive.visit("deepest_a", report.deepestA);
    archive.visit("deepest_b", report.deepestB);
    archive.visit("contact_steps", report.contactSteps);
    archive.visit("body_steps", report.bodySteps);
    archive.visit("stage_seconds", report.seconds, {"s", ""});
    archive.visit("trouble_counts", report.troubleCounts);
    visitTroubles(archive, report.troubles);
  });
}

/// What the servos of moving walls remember. Where a wall is follows from the time.
void visitWalls(Archive& archive, World& world) {
  archive.inGroup("walls", [&] {
    std::vector<double> way, speed;
    for (const auto& wall : world.walls) {
      way.push_back(wall->servoWay);
      speed.push_back(wall->servoSpeed);
    }
    archive.visit("force", world.wallForces, {"N", "on each wall"});
    archive.visit("stiffness", world.wallStiffness, {"N/m", "of the contacts of walls with a servo"});
    archive.visit("servo_way", way, {"m", ""});
    archive.visit("servo_speed", speed, {"m/s", ""});
    if (!archive.loading()) return;
    require(way.size() == world.walls.size() && speed.size() == world.walls.size(),
            "checkpoint: as many walls as the scene has are expected");
    for (std::size_t k = 0; k < way.size(); ++k) {
      world.walls[k]->servoWay = way[k];
      world.walls[k]->servoSpeed = speed[k];
      world.walls[k]->place(world.time);
    }
  });
}

}  // namespace

void describe(Archive& archive, World& world) {
  archive.visit("time", world.time, {"s", "of t_n"});
  archive.visit("steps", world.steps);
  archive.visit("wall_travel", world.wallTravel, {"m", ""});
  archive.visit("next_id", world.nextId);
  archive.visit("sleep_on", world.options.sleep.on);
  if (archive.loading()) world.pairs = PairList{};  // of bodies placed before loading
  archive.inGroup(
      "bodies", [&] { world.bodies.visitState([&](const char* name, auto& column) { archive.visit(name, column); }); });
  visitPairs(archive, world.pairs);
  visitWallPairs(archive, world.pairs.wallPairs);
  archive.inGroup("search", [&] {
    if (!archive.loading()) world.search.packBoxes();
    world.search.visitState([&](const char* name, auto& column) { archive.visit(name, column); });
    archive.visit("refreshes", world.search.refreshes);
  });
  archive.inGroup("sleep", [&] {
    world.sleep.visitColumns([&](const char* name, auto& column, const char* unit, const char* note) {
      archive.visit(name, column, {unit, note});
    });
    archive.visit("energy_let_go", world.sleep.energyLetGo, {"J", ""});
    archive.visit("fallen", world.sleep.fallen);
    archive.visit("woken", world.sleep.woken);
  });
  archive.inGroup("ledger",
                  [&] { world.ledger.visitState([&](const char* name, auto& value) { archive.visit(name, value); }); });
  if (archive.loading() && !world.options.energy) {
    world.ledger = EnergyLedger{};
    world.pairs.memory.energy.clear();
  }
  visitWalls(archive, world);
  visitReport(archive, world.report);
  if (!archive.loading()) return;
  world.bodies.restoreDerived(world.shapes);
  world.search.restoreBoxes(world.bodies);
  world.chunks.clear();
  layOutContacts(world);
}

void describe(Archive& archive, PourState& state) {
  archive.visit("placed", state.placed);
  archive.visit("batches", state.batches);
  archive.visit("batch_left", state.batchLeft);
  archive.visit("calls", state.calls);
  archive.visit("attempts", state.attempts);
  archive.visit("postponed", state.postponed);
  archive.visit("next_time", state.nextTime, {"s", ""});
  archive.visit("refusals", state.refusals);
}

void describe(Archive& archive, RunProgress& progress) {
  archive.visit("calm", progress.calm, {"s", ""});
  archive.visit("batch_start", progress.batchStart, {"s", ""});
  archive.visit("poured_at", progress.pouredAt, {"s", ""});
  archive.visit("consolidated", progress.consolidated);
  archive.visit("awake", progress.awake);
  archive.visit("frozen_below", progress.frozenBelow);
  archive.visit("late_batches", progress.lateBatches);
  archive.visit("frames", progress.frames);
  archive.visit("next_frame", progress.nextFrame, {"s", ""});
  archive.visit("next_checkpoint", progress.nextCheckpoint, {"s", ""});
  archive.visit("wall", progress.wall, {"s", ""});
  archive.visit("smallest_bound", progress.smallestBound, {"s", ""});
}

void describe(Archive& archive, EnergySeries& series) {
  auto columns = static_cast<std::uint64_t>(series.columns);
  archive.visit("interval", series.interval, {"s", "between rows"});
  archive.visit("next", series.next, {"s", ""});
  archive.visit("columns", columns);
  archive.visit("numbers", series.numbers, {"", "row by row: time in s, entries of the ledger in J"});
  series.columns = columns;
}

void describe(Archive& archive, std::vector<FrameSeries::Entry>& frames) {
  std::vector<double> times;
  std::vector<std::string> files;
  for (const FrameSeries::Entry& entry : frames) {
    times.push_back(entry.time);
    files.push_back(entry.file);
  }
  archive.visit("time", times, {"s", ""});
  archive.visit("file", files);
  frames.clear();
  for (std::size_t k = 0; k < times.size(); ++k) frames.push_back({times[k], files[k]});
}

}  // namespace granular
