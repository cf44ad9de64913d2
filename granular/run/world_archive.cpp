#include "granular/run/world_archive.h"

#include <array>
#include <map>
#include <numeric>

#include "granular/run/packing_run.h"
#include "granular/run/world_check.h"
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
void visitField(Archive& archive, std::string_view name, std::vector<Row>& rows, Field field, const Note& note = {}) {
  std::vector<T> column;
  column.reserve(rows.size());
  for (Row& row : rows) column.push_back(static_cast<T>(field(row)));
  archive.visit(name, column, note);
  if (!archive.loading()) return;
  require(column.size() == rows.size(),
          "checkpoint: column " + std::string(name) + " is of another length than its neighbours");
  for (std::size_t k = 0; k < rows.size(); ++k)
    field(rows[k]) = static_cast<std::decay_t<decltype(field(rows[k]))>>(column[k]);
}

/// The number of rows, which loading gives to the list; `column` is one that follows.
template <class Row>
void visitCount(Archive& archive, std::vector<Row>& rows, std::string_view column) {
  auto count = static_cast<std::uint64_t>(rows.size());
  archive.visit("count", count);
  require(!archive.loading() || archive.rowsOf(column) == count,
          "checkpoint: column " + std::string(column) + " has not as many rows as its group counts");
  rows.resize(count);
}

/// Lists of lists: how many entries each of `rows` has must add up to the entries there are.
void requireCounts(std::string_view name, const std::vector<std::int32_t>& counts, std::size_t rows,
                   std::size_t entries) {
  bool fits = counts.size() == rows;
  std::uint64_t sum = 0;
  for (const std::int32_t count : counts) {
    fits = fits && count >= 0;
    sum += static_cast<std::uint64_t>(std::max(count, 0));
  }
  require(fits && sum == entries, "checkpoint: column " + std::string(name) + " does not count the entries there are");
}

void visitHistory(Archive& archive, std::vector<ContactHistory>& rows) {
  archive.visitMember("spring", rows, &ContactHistory::spring, {"m", "tangential spring, world axes"});
  archive.visitMember("normal", rows, &ContactHistory::normal, {"", "normal of the last step; zero: no contact"});
  archive.visitMember("twist", rows, &ContactHistory::twist, {"rad", "torsional spring"});
}

/// A row that stands for no contact: every byte is defined, so that equal states make equal files.
Contact makeNoContact() {
  Contact none;
  none.shift = none.torqueA = none.torqueB = Vec3::Zero();
  none.touch = {Vec3::Zero(), 0, Vec3::Zero(), Vec3::Zero()};
  none.patch.point = none.patch.centre = Vec3::Zero();
  return none;
}

void visitContacts(Archive& archive, std::vector<Contact>& rows) {
  visitCount(archive, rows, "a");
  for (Contact& row : rows) {
    if (archive.loading() || row.a < 0) row = makeNoContact();
  }
  const auto number = [&](const char* name, auto field, const Note& note = {}) {
    visitField<double>(archive, name, rows, field, note);
  };
  const auto vector = [&](const char* name, auto field, const Note& note = {}) {
    visitField<Vec3>(archive, name, rows, field, note);
  };
  const auto index = [&](const char* name, auto field, const Note& note = {}) {
    visitField<std::int32_t>(archive, name, rows, field, note);
  };
  const auto flag = [&](const char* name, auto field) { visitField<std::uint8_t>(archive, name, rows, field); };
  // clang-format off
  index("pair", [](Contact& c) -> auto& { return c.pair; });
  index("a", [](Contact& c) -> auto& { return c.a; }, {"", "slot of a body; -1: no contact in this row"});
  index("b", [](Contact& c) -> auto& { return c.b; }, {"", "slot of a body; -1 - w: wall w"});
  index("spot", [](Contact& c) -> auto& { return c.spot.number; });
  index("child_a", [](Contact& c) -> auto& { return c.spot.childA; });
  index("child_b", [](Contact& c) -> auto& { return c.spot.childB; });
  number("share", [](Contact& c) -> auto& { return c.share; });
  vector("shift", [](Contact& c) -> auto& { return c.shift; }, {"m", "of b's image"});
  vector("normal", [](Contact& c) -> auto& { return c.touch.normal; }, {"", "from a to b"});
  number("overlap", [](Contact& c) -> auto& { return c.touch.overlap; }, {"m", ""});
  vector("on_a", [](Contact& c) -> auto& { return c.touch.onA; }, {"m", "deepest point of a"});
  vector("on_b", [](Contact& c) -> auto& { return c.touch.onB; }, {"m", ""});
  vector("point", [](Contact& c) -> auto& { return c.patch.point; }, {"m", "contact point"});
  vector("centre", [](Contact& c) -> auto& { return c.patch.centre; }, {"m", "of the patch"});
  number("area", [](Contact& c) -> auto& { return c.patch.area; }, {"m^2", "of the patch"});
  vector("u", [](Contact& c) -> auto& { return c.patch.u; }, {"", "axis of its moments"});
  number("uu", [](Contact& c) -> auto& { return c.patch.uu; }, {"m^2", "second moment per area"});
  number("vv", [](Contact& c) -> auto& { return c.patch.vv; }, {"m^2", ""});
  number("uv", [](Contact& c) -> auto& { return c.patch.uv; }, {"m^2", ""});
  number("depth", [](Contact& c) -> auto& { return c.patch.depth; }, {"m", "the elastic force is k_n times this"});
  number("squared_depth", [](Contact& c) -> auto& { return c.patch.squaredDepth; }, {"m^2", ""});
  number("rule_share", [](Contact& c) -> auto& { return c.patch.share; }, {"", "of the stiffness, by the rule"});
  vector("force", [](Contact& c) -> auto& { return c.force.force; }, {"N", "on a"});
  vector("couple", [](Contact& c) -> auto& { return c.force.couple; }, {"N m", "on a"});
  number("normal_force", [](Contact& c) -> auto& { return c.force.normalForce; }, {"N", ""});
  flag("sliding", [](Contact& c) -> auto& { return c.force.sliding; });
  flag("held", [](Contact& c) -> auto& { return c.held; });
  vector("torque_a", [](Contact& c) -> auto& { return c.torqueA; }, {"N m", "about a's centre"});
  vector("torque_b", [](Contact& c) -> auto& { return c.torqueB; }, {"N m", ""});
  // clang-format on
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
  requireCounts("spot_count", counts, rows.size(), spots.size());
  require(histories.size() == spots.size() && energies.size() == spots.size(),
          "checkpoint: spots, their histories and their springs are not equally many");
  std::size_t next = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::int32_t n = 0; n < counts[k]; ++n, ++next)
      rows[k].spots.push_back({spots[next], histories[next], energies[next]});
  }
}

void visitManifolds(Archive& archive, std::vector<ManifoldMemory>& rows) {
  visitCount(archive, rows, "points");
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
  requireCounts("children_count", counts, rows.size(), all.size());
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
  visitCount(archive, rows, "children_until");
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
  requireCounts("cache_count", counts, rows.size(), caches.size());
  requireCounts("held_count", heldCounts, rows.size(), held.size());
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
    if (archive.loading()) memory.slots = memory.history.size();
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
    visitCount(archive, pairs, "body");
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
    requireCounts("held_count", heldCount, pairs.size(), held.size());
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

/// Units and meanings of columns that the owners of the state only name.
struct NamedNote {
  std::string_view name;
  Note note;
};
constexpr NamedNote bodyNotes[] = {
    {"x", {"m", "position at t_n"}},
    {"q", {"", "orientation at t_n, body to world, x y z w"}},
    {"v", {"m/s", "at t_n, predicted"}},
    {"w", {"rad/s", "at t_n, predicted, world axes"}},
    {"v_half", {"m/s", "at the half step"}},
    {"w_half", {"rad/s", "at the half step, body axes"}},
    {"q_half", {"", "orientation at the half step, x y z w"}},
    {"spin_half", {"rad/s", "at the half step, world axes"}},
    {"acceleration", {"m/s^2", "of the last step"}},
    {"alpha", {"rad/s^2", "of the last step, body axes"}},
    {"force", {"N", ""}},
    {"torque", {"N m", "about the centre of mass, world axes"}},
    {"travel", {"m", "bound on the way of any surface point so far"}},
    {"mass", {"kg", ""}},
    {"inverse_mass", {"1/kg", "0: does not move"}},
    {"inertia", {"kg m^2", "principal"}},
    {"inverse_inertia", {"1/(kg m^2)", "0: does not turn"}},
    {"radius_ratio", {"1/kg", "mean square radius over mean inertia"}},
    {"shape_index", {"", "in the order in which shapes are made again"}},
    {"material", {"", "in the scene's order"}},
    {"id", {"", "for life"}},
    {"state", {"", "0 moving, 1 frozen, 2 asleep"}},
    {"locks", {"", "bits: axes along or about which it does not move"}},
};
constexpr NamedNote searchNotes[] = {
    {"margin", {"m", "by which a body's box is grown"}},
    {"travel_at_place", {"m", "the body's and the walls' travel when its box was placed"}},
    {"lowest", {"m", "corner of the box"}},
    {"highest", {"m", "corner of the box"}},
};
constexpr NamedNote ledgerNotes[] = {
    {"kinetic", {"J", ""}},
    {"potential", {"J", ""}},
    {"normal_springs", {"J", ""}},
    {"tangential_springs", {"J", ""}},
    {"normal_dashpots", {"J", ""}},
    {"tangential_dashpots", {"J", ""}},
    {"friction", {"J", ""}},
    {"wall", {"J", "work of walls"}},
    {"rule", {"J", "contact-rule work"}},
    {"exchanged", {"J", ""}},
    {"parted", {"J", ""}},
    {"contact_work", {"J", ""}},
    {"gravity_work", {"J", ""}},
    {"peak", {"J", "largest kinetic and elastic energy"}},
};

template <std::size_t N>
Note noteOf(const NamedNote (&notes)[N], std::string_view name) {
  for (const NamedNote& each : notes) {
    if (each.name == name) return each.note;
  }
  return {};
}

}  // namespace

void describe(Archive& archive, World& world) {
  archive.visit("time", world.time, {"s", "of t_n"});
  archive.visit("steps", world.steps);
  archive.visit("wall_travel", world.wallTravel, {"m", ""});
  archive.visit("next_id", world.nextId);
  archive.visit("sleep_on", world.options.sleep.on);
  if (archive.loading()) {  // what there is of bodies placed before
    world.pairs = PairList{};
    world.pairsOfBodies = {};
    world.chunks.clear();
    world.historiesFiled = true;
    world.aloft = {};
  }
  archive.inGroup("bodies", [&] {
    if (!archive.loading()) world.bodies.makeTurnColumns();
    world.bodies.visitState(
        [&](const char* name, auto& column) { archive.visit(name, column, noteOf(bodyNotes, name)); });
    if (!archive.loading()) world.bodies.leaveOutNeedless();
  });
  const bool keepsHistories = !world.historiesFiled;
  fileHistories(world);
  visitPairs(archive, world.pairs);
  if (keepsHistories) takeHistories(world);
  visitWallPairs(archive, world.pairs.wallPairs);
  archive.inGroup("search", [&] {
    if (!archive.loading()) world.search.packBoxes();
    world.search.visitState(
        [&](const char* name, auto& column) { archive.visit(name, column, noteOf(searchNotes, name)); });
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
  archive.inGroup("ledger", [&] {
    world.ledger.visitState(
        [&](const char* name, auto& value) { archive.visit(name, value, noteOf(ledgerNotes, name)); });
  });
  if (archive.loading() && !world.options.energy) {
    world.ledger = EnergyLedger{};
    world.pairs.memory.energy.clear();
  }
  visitWalls(archive, world);
  visitReport(archive, world.report);
  if (!archive.loading()) return;
  checkLoaded(world);
  world.bodies.restoreDerived(world.shapes, world.turningOfBalls());
  world.search.restoreBoxes(world.bodies);
  layOutContacts(world);
}

void describe(Archive& archive, SceneSource& source) {
  std::string file = source.file.string();
  archive.visit("file", file, {"", "path of the scene file"});
  source.file = file;
  archive.visit("text", source.text, {"", "its content"});
  archive.visit("overrides", source.overrides, {"", "key.path=value"});
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
  archive.inGroup("energy", [&] {
    archive.visit("before", progress.energy.before, {"J", "largest kinetic and potential energy of the block before"});
    archive.visit("now", progress.energy.now, {"J", "largest of this block"});
    archive.visit("until", progress.energy.until, {"s", "end of this block"});
  });
  archive.visit("answers", progress.answers, {"", "to troubles"});
  archive.visit("removed", progress.removed, {"", "ids of particles taken out"});
}

void describe(Archive& archive, EnergySeries& series) {
  auto columns = static_cast<std::uint64_t>(series.columns);
  archive.visit("interval", series.interval, {"s", "between rows"});
  archive.visit("next", series.next, {"s", ""});
  archive.visit("columns", columns);
  archive.visit("numbers", series.numbers, {"", "row by row: time in s, entries of the ledger in J"});
  require(columns <= 1000 && (columns == 0 ? series.numbers.empty() : series.numbers.size() % columns == 0),
          "checkpoint: energy_series/numbers has no whole rows");
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
