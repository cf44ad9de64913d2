#include "granular/run/packing_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <set>
#include <sstream>

#include "granular/insert/pose_check.h"
#include "granular/io/checkpoint.h"
#include "granular/io/pose_file.h"
#include "granular/io/progress.h"
#include "granular/io/scene_file.h"
#include "granular/run/frames.h"
#include "granular/run/particle_groups.h"
#include "granular/run/scene_world.h"
#include "granular/run/world_archive.h"
#include "granular/world/stages.h"

namespace granular {
namespace {

using Clock = std::chrono::steady_clock;

/// Steps between looks at the whole bed: often enough to see a rest of milliseconds, seldom enough to cost nothing.
std::int64_t observationSteps(double dt) { return std::max<std::int64_t>(1, std::llround(1e-4 / dt)); }

/// Steps between states kept in memory to go back to: a copy costs about as much as one step. A whole number of looks.
std::int64_t keepingSteps(double dt) {
  const std::int64_t look = observationSteps(dt);
  return (1000 + look - 1) / look * look;
}

/// What may differ from the interrupted run without touching its motion.
bool mayChangeOnResume(std::string_view entry) {
  const std::string_view key = entry.substr(0, entry.find('='));
  return key == "threads" || key == "time.max_time" || key.starts_with("rest.") || key.starts_with("output.") ||
         key.starts_with("limits.");
}

}  // namespace

std::string_view runEndName(RunEnd end) {
  switch (end) {
    case RunEnd::rested:
      return "rested";
    case RunEnd::completed:
      return "ran to the end of its time";
    case RunEnd::notRested:
      return "not at rest in the time given";
    case RunEnd::trouble:
      return "stopped by trouble";
    case RunEnd::interrupted:
      return "interrupted";
    case RunEnd::outOfTime:
      return "out of time";
  }
  return {};
}

SceneSource SceneSource::read(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  std::ifstream stream(file);
  require(stream.good(), fmt::format("{}: can't be read", file.string()));
  std::ostringstream text;
  text << stream.rdbuf();
  return {std::filesystem::absolute(file), text.str(), overrides};
}

Scene SceneSource::parse() const { return parseScene(text, file, overrides); }

namespace {

/// The world axes that a group may not move along or turn about.
Locks locksOf(const ParticleSettings& group) {
  Locks locks = 0;
  for (const std::string& axis : group.lockTranslation) locks |= lockTranslation(axis[0] - 'x');
  for (const std::string& axis : group.lockRotation) locks |= lockRotation(axis[0] - 'x');
  return locks;
}

}  // namespace

PackingRun::PackingRun(SceneSource source)
    : origin(std::move(source)), settings(origin.parse()), state(makeWorld(settings)) {
  for (const ParticleSettings& group : settings.particles) {
    materialOfGroup.push_back(settings.materialIndex(group.material));
    densityOfGroup.push_back(settings.materials[static_cast<std::size_t>(materialOfGroup.back())].density);
    locksOfGroup.push_back(locksOf(group));
  }
  makePour();
  placePoses();
  chooseTimes();
  startHalfSteps(*state, dt, 0, true);
  if (pour->isDone()) counters.pouredAt = state->time;  // poses and beds have nothing to wait for
}

Vessel PackingRun::vessel() const { return makeVessel(settings); }

void PackingRun::makePour() {
  const InsertionSettings& insertion = settings.insertion;
  std::vector<PourGroup> groups = makePourGroups(settings);
  PourOptions options;
  options.kind = insertion.kind == InsertionSettings::Kind::rain   ? PourOptions::Kind::rain
                 : insertion.kind == InsertionSettings::Kind::drop ? PourOptions::Kind::drop
                                                                   : PourOptions::Kind::batches;
  options.from = insertion.from;
  options.to = insertion.to;
  options.turn = static_cast<PourOptions::Turn>(insertion.turn);
  options.minBatch = static_cast<std::int64_t>(insertion.batch.lo);
  options.maxBatch = static_cast<std::int64_t>(insertion.batch.hi);
  options.rate = insertion.rate;
  options.height = insertion.height;
  options.speed = insertion.speed;
  options.upright = insertion.orientation == InsertionSettings::Orientation::upright;
  std::vector<const Wall*> walls;
  for (const auto& wall : state->walls) walls.push_back(wall.get());
  pour = std::make_unique<Inserter>(options, std::move(groups), makeRegion(settings), walls, settings.seed);
  state->bodies.reserve(static_cast<std::size_t>(pour->count()));
}

void PackingRun::placePoses() {
  const InsertionSettings& insertion = settings.insertion;
  if (insertion.kind == InsertionSettings::Kind::bed) {
    // The bodies of an earlier run, at rest where they were.
    const PackingRun earlier = PackingRun::resumed(insertion.file);
    const World& old = earlier.world();
    for (const std::int32_t slot : old.bodies.slotsById()) {
      const auto i = static_cast<std::size_t>(slot);
      const std::string& material = old.materials.name(old.bodies.material[i]);
      const auto isNamed = [&](const MaterialSettings& known) { return known.name == material; };
      require(std::any_of(settings.materials.begin(), settings.materials.end(), isNamed),
              fmt::format("{}: insertion.file = {}: particle {} of that bed is of material '{}', which the scene lacks",
                          settings.file.string(), insertion.file.string(), old.bodies.id[i], material));
      NewBody body;
      body.shapeIndex = state->addShape(old.shapes[static_cast<std::size_t>(old.bodies.shapeIndex[i])]);
      body.material = settings.materialIndex(material);
      body.density = old.bodies.mass[i] / old.bodies.shape[i]->massProperties().volume;
      body.locks = old.bodies.locks[i];
      body.pose = old.bodies.poseOf(i);
      state->addBody(body);
    }
  }
  if (insertion.kind == InsertionSettings::Kind::poses) {
    Random random(settings.seed);
    const std::vector<PourGroup> groups = makePourGroups(settings);
    for (const GroupPose& given : readPoseFile(insertion.file, static_cast<int>(groups.size()))) {
      const auto group = static_cast<std::size_t>(given.group);
      NewBody body;
      body.shapeIndex = state->addShape(groups[group].make(groups[group].size.draw(random), random));
      body.material = materialOfGroup[group];
      body.density = densityOfGroup[group];
      body.locks = locksOfGroup[group];
      body.pose = given.pose;
      state->addBody(body);
    }
  }
  // Whatever was given must not overlap beyond what the scene accepts.
  std::vector<PlacedShape> placed;
  for (std::size_t i = 0; i < state->bodies.size(); ++i)
    placed.push_back({state->bodies.shape[i], state->bodies.frameOf(i)});
  std::vector<const Wall*> walls;
  for (const auto& wall : state->walls) walls.push_back(wall.get());
  if (placed.empty()) return;
  try {
    checkBelow(makeRegion(settings).ceiling, placed, state->bodies.id, insertion.maxOverlap);
    checkPoses(placed, state->bodies.id, state->options.periods, walls, insertion.maxOverlap);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", insertion.file.string(), error.what()));
  }
}

void PackingRun::chooseTimes() {
  // Each shape that will take part, once.
  std::vector<BodyKind> kinds;
  std::set<std::pair<const Shape*, int>> seen;
  std::vector<std::shared_ptr<const Shape>> alive;
  const auto add = [&](const Shape& shape, int material, double density) {
    if (seen.emplace(&shape, material).second) kinds.push_back({&shape, material, density});
  };
  const Bodies& bodies = state->bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    add(*bodies.shape[i], bodies.material[i], bodies.mass[i] / bodies.shape[i]->massProperties().volume);
  }
  for (std::int64_t number = 0; number < pour->count(); ++number) {
    const auto group = static_cast<std::size_t>(pour->groupOf(number));
    alive.push_back(pour->makeShape(number));
    add(*alive.back(), materialOfGroup[group], densityOfGroup[group]);
  }
  stepBound = boundBeforeRun(kinds, state->materials, state->options, static_cast<int>(settings.time.contacts));
  if (settings.time.step) {
    dt = *settings.time.step;
    require(dt <= stepBound.bound, fmt::format("{}: time.step = {:g} s is above the stability bound {:.4g} s ({})",
                                               settings.file.string(), dt, stepBound.bound, stepBound.explanation));
  } else {
    dt = settings.time.fraction * stepBound.bound;
  }
  for (const BodyKind& kind : kinds) smallestSize = std::min(smallestSize, kind.shape->size());
  limitSpeed();
  // Waves of an impact pass within some ten contact times.
  state->options.sleep.time = settings.settle.time.value_or(50 * stepBound.contactTime);
  state->options.sleep.average = settings.settle.average.value_or(25 * stepBound.contactTime);
}

void PackingRun::limitSpeed() {
  state->options.maxSpeed = std::min(settings.limits.maxSpeed, settings.limits.maxTravel * smallestSize / dt);
}

void PackingRun::addParticle(const NewParticle& particle) {
  const auto group = static_cast<std::size_t>(particle.group);
  NewBody body;
  body.shapeIndex = state->addShape(particle.shape);
  body.material = materialOfGroup[group];
  body.density = densityOfGroup[group];
  body.locks = locksOfGroup[group];
  body.pose = particle.pose;
  body.velocity = particle.velocity;
  counters.energy.add(mechanicalEnergy(*state, state->addBody(body)));
}

void PackingRun::insertDue() {
  if (pour->isDone() || !pour->isDue(state->time, counters.consolidated)) return;
  land(*state);
  // A batch that found no room for its last particles goes on while the first are still falling: those stay free.
  if (settings.settle.kind == SettleSettings::Kind::freeze && counters.consolidated) freezeConsolidated();
  std::vector<PlacedShape> present;
  for (std::size_t i = 0; i < state->bodies.size(); ++i)
    present.push_back({state->bodies.shape[i], state->bodies.frameOf(i)});
  const std::size_t first = state->bodies.size();
  for (const NewParticle& particle : pour->insert(state->time, counters.consolidated, present)) addParticle(particle);
  takeOut();
  startHalfSteps(*state, dt, std::min(first, state->bodies.size()), false);
  if (state->bodies.size() > first) {
    counters.consolidated = false;
    counters.calm = 0;
    counters.batchStart = state->time;
  }
  require(!pour->isFull() || state->bodies.size() > 0,
          fmt::format("{}: no particle fits below the vessel's rim at {:g} m", settings.file.string(),
                      makeRegion(settings).ceiling));
  if (pour->isDone()) counters.pouredAt = state->time;
}

void PackingRun::freezeConsolidated() {
  Bodies& bodies = state->bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.moves(i)) bodies.hold(i, BodyState::frozen);
  }
  state->search.invalidate();  // pairs of two frozen bodies are no longer needed
  counters.frozenBelow = state->nextId;
}

double PackingRun::restlessness() const {
  const Bodies& bodies = state->bodies;
  const double gravity = state->options.gravity.norm();
  // While pouring, the moving are measured against one batch; in the end, against the whole bed.
  double energy = 0, scale = 0;
  const double batch = settings.insertion.batch.hi;
  double counted = 0;
  for (std::size_t i = bodies.size(); i-- > 0;) {
    energy += bodies.kineticEnergy(i);
    if (counters.pouredAt < 0 && counted >= batch) continue;
    scale += weightTimesSize(bodies, i, gravity);
    ++counted;
  }
  return scale > 0 ? energy / scale : 0;
}

bool PackingRun::isCalm(double energy, double time) const {
  // What begins to fall is slow too, while m g h < energy m g d with h = g t^2 / 2.
  double largest = 0;
  for (const Shape* shape : state->bodies.shape) largest = std::max(largest, 2 * shape->size());
  const double gravity = state->options.gravity.norm();
  const double slowFall = gravity > 0 ? std::sqrt(2 * energy * largest / gravity) : 0;
  return counters.calm >= std::max(time, 1.2 * slowFall);
}

double PackingRun::settlesFrom() const {
  double stop = 0;
  for (const auto& wall : state->walls) stop = std::max(stop, wall->stopTime());
  return stop;
}

void PackingRun::observe(double interval) {
  const bool pouring = !pour->isDone();
  const double bound = pouring ? settings.insertion.energy : settings.rest.energy;
  counters.calm = restlessness() < bound ? counters.calm + interval : 0;
  if (pouring && !counters.consolidated) {
    counters.consolidated = isCalm(bound, settings.insertion.time);
    if (!counters.consolidated && state->time - counters.batchStart > settings.insertion.maxTime) {
      counters.consolidated = true;
      ++counters.lateBatches;
    }
  }
  const bool settling = !pouring && state->time >= settlesFrom();
  if (settling && !counters.awake && isCalm(bound, settings.rest.time)) {
    // Rest must hold with every body awake.
    wakeAll(*state);
    state->options.sleep.on = false;
    counters.awake = true;
    if (state->sleep.fallen > 0) counters.calm = 0;
  }
  checkDomain(*state);
  watchEnergy();
  const TimeStepBound now = boundOfContacts(*state);
  counters.smallestBound = std::min(counters.smallestBound, now.bound);
}

bool PackingRun::isResting() const {
  return pour->isDone() && state->time >= settlesFrom() && counters.awake &&
         isCalm(settings.rest.energy, settings.rest.time);
}

RunEnd PackingRun::run(const std::filesystem::path& out, const volatile std::sig_atomic_t& stop) {
  checkFolder(out);
  const double wallBefore = counters.wall;
  Progress line;
  auto writer = std::make_unique<FrameWriter>(out, settings, frames);
  double savedAt = 0;
  const auto finish = [&](RunEnd end) {
    counters.wall = wallBefore + line.elapsed();
    save(out, end);
    line.finish();
    return end;
  };
  const auto inTrouble = [&] {
    return settings.limits.onTrouble != LimitSettings::Action::proceed && !state->report.troubles.empty();
  };

  keepGood();
  while (true) {
    insertDue();
    step(*state, dt);
    const std::int64_t lookEvery = observationSteps(dt);
    const bool looks = state->steps % lookEvery == 0;
    if (looks || inTrouble()) land(*state);
    if (looks && !inTrouble()) observe(static_cast<double>(lookEvery) * dt);
    if (inTrouble()) {
      if (!answerTrouble()) return finish(RunEnd::trouble);
      line.say(counters.answers.back());
      writer = std::make_unique<FrameWriter>(out, settings, frames);
      continue;
    }
    if (!looks) continue;
    if (settings.output.energy) energies.record(state->time + 0.5 * dt, state->ledger);
    counters.wall = wallBefore + line.elapsed();
    line.report(shareDone(), [&] { return describeProgress(); });
    if (settings.output.frames && state->time >= counters.nextFrame) {
      writer->write(*state, counters.frames++);
      frames = writer->entries();
      counters.nextFrame += *settings.output.frames;
    }
    if (isResting()) return finish(RunEnd::rested);
    if (stop) return finish(RunEnd::interrupted);
    if (counters.wall > settings.limits.wallTime || state->time >= settings.time.maxTime)
      return finish(std::isinf(settlesFrom()) && state->time >= settings.time.maxTime ? RunEnd::completed
                                                                                      : RunEnd::outOfTime);
    if (pour->isDone() && state->time - std::max(counters.pouredAt, settlesFrom()) > settings.rest.maxTime)
      return finish(RunEnd::notRested);
    if (state->steps % keepingSteps(dt) == 0) keepGood();
    if (line.elapsed() - savedAt > settings.output.checkpointEvery || state->time >= counters.nextCheckpoint) {
      counters.nextCheckpoint = state->time + settings.output.checkpointInterval;
      save(out, RunEnd::interrupted);
      savedAt = line.elapsed();
    }
  }
}

double PackingRun::shareDone() const {
  // Pouring is most of the work; the final rest comes by itself.
  const double poured =
      !pour->isDone() ? static_cast<double>(pour->state().placed) / static_cast<double>(pour->count()) : 1;
  // The cost of a step grows with the particles: the work done is nearly the square of the share poured.
  return 0.9 * poured * poured + (isResting() ? 0.1 : 0);
}

std::string PackingRun::describeProgress() const {
  const Bodies& bodies = state->bodies;
  const auto asleep = std::count(bodies.state.begin(), bodies.state.end(), BodyState::asleep);
  const std::int64_t left = pour->isDone() ? 0 : pour->count() - pour->state().placed;
  return fmt::format(
      "t = {:.3f} s, {} of {} particles, {} asleep, {} contacts, kinetic energy {:.1e} m g d, deepest overlap {:.2f} %",
      state->time, bodies.size(), static_cast<std::int64_t>(bodies.size()) + left, asleep, state->contactCount(),
      restlessness(), 100 * state->report.deepestOverlap);
}

void PackingRun::checkFolder(const std::filesystem::path& out) const {
  if (settings.insertion.kind != InsertionSettings::Kind::bed) return;
  // Resuming needs both checkpoints: the bed's and this run's.
  std::error_code ignored;
  const std::filesystem::path& bed = settings.insertion.file;
  const std::filesystem::path home = std::filesystem::is_directory(bed, ignored) ? bed : bed.parent_path();
  require(!std::filesystem::equivalent(home, out, ignored),
          fmt::format("{}: the output folder holds the bed this run starts from; choose another", out.string()));
}

void PackingRun::visitState(Archive& archive) {
  archive.visit("time_step", dt, {"s", ""});
  PourState poured = pour->state();
  archive.visitGroup("pouring", poured);
  if (archive.loading()) {
    require(dt > 0 && std::isfinite(dt), fmt::format("checkpoint: time_step = {:g} s: must be > 0 and finite", dt));
    require(poured.placed >= 0 && poured.placed <= pour->count(),
            fmt::format("checkpoint: pouring/placed = {}: must be 0 to {}", poured.placed, pour->count()));
    // Shapes are made again from the seed, in the order in which they came.
    for (std::int64_t number = 0; number < poured.placed; ++number) state->addShape(pour->makeShape(number));
    pour->setState(poured);
  }
  limitSpeed();
  archive.visitGroup("run", counters);
  archive.visitGroup("frames", frames);
  archive.visitGroup("energy_series", energies);
  archive.visitGroup("world", *state);
}

PackingRun PackingRun::resumed(const std::filesystem::path& folder, const std::vector<std::string>& overrides) {
  Archive archive = loadCheckpoint(folder);
  require(archive.has("scene"),
          fmt::format("{}: the checkpoint can't be used: it is not that of a packing", folder.string()));
  SceneSource source;
  archive.visitGroup("scene", source);
  for (const std::string& entry : overrides) {
    require(mayChangeOnResume(entry),
            fmt::format("{}: can't be changed when a run is resumed; threads, time.max_time, rest.*, output.* and "
                        "limits.* can",
                        entry));
    source.overrides.push_back(entry);
  }
  PackingRun run(std::move(source));
  run.visitState(archive);
  archive.requireAllRead();
  return run;
}

std::string PackingRun::describePlan() const {
  const double particles =
      static_cast<double>(pour->count() - pour->state().placed) + static_cast<double>(state->bodies.size());
  const double batch = 0.5 * (settings.insertion.batch.lo + settings.insertion.batch.hi);
  // A batch needs a fall of some millimetres and a few bounces: about .08 s; the end about .3 s.
  const double simulated = settings.insertion.rate > 0
                               ? static_cast<double>(pour->count()) / settings.insertion.rate + 0.3
                               : 0.08 * static_cast<double>(pour->count()) / batch + 0.3;
  const double steps = simulated / dt;
  // Half of the particles on average, two microseconds each on one core.
  const double wall = 0.5 * particles * steps * 2e-6;
  std::string text;
  text += fmt::format("scene: {} ({})\n", settings.name, settings.file.string());
  text += fmt::format("particles: {:.0f}", particles);
  for (const ParticleSettings& group : settings.particles) text += fmt::format(", {}", group.name);
  text +=
      fmt::format("\ntime step: {:.4g} s = {:.3g} of the bound; {}\n", dt, dt / stepBound.bound, stepBound.explanation);
  text += fmt::format("model: {}, {}, {}\n", settings.model.law, pointRuleName(state->options.rule.rule),
                      settings.model.integrator);
  text += describeSkips(settings) + "\n";
  text += fmt::format("expected: {:.2g} s simulated, {:.2g} steps, {:.0f} s on one core, {:.0f} MB\n", simulated, steps,
                      wall, 20 + particles * 8e-3);
  return text;
}

}  // namespace granular
