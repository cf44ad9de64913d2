#include "granular/body/bodies.h"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "granular/core/pick.h"
#include "granular/core/room.h"

namespace granular {

void Bodies::reserve(std::size_t count) {
  visitState([&](const char*, auto& column) {
    using Row = typename std::remove_reference_t<decltype(column)>::value_type;
    if constexpr (!std::is_same_v<Row, Quat>) column.reserve(count);  // there may be none
  });
  boundingRadius.reserve(count);
  shape.reserve(count);
  turning.reserve(count);
  aloft.reserve(count);
}

Bodies::Turning Bodies::turningOf(const Shape& bodyShape, const Vec3& moments, Turning ofBalls) {
  const bool isBall = bodyShape.isRound() && moments.x() == moments.y() && moments.y() == moments.z();
  return isBall ? ofBalls : Turning::byScheme;
}

void Bodies::makeOrientations() {
  if (!q.empty()) return;
  q.reserve(x.capacity());
  qHalf.reserve(x.capacity());
  frame.reserve(x.capacity());
  q.assign(size(), noTurn);
  qHalf.assign(size(), noTurn);
  frame.clear();
  for (const Vec3& centre : x) frame.emplace_back(Mat3::Identity(), centre);
}

void Bodies::dropNeedlessOrientations() {
  for (std::size_t i = 0; i < size(); ++i) {
    if (!staysUpright(*shape[i], turning[i])) return;
  }
  discard(q);
  discard(qHalf);
  discard(frame);
}

std::size_t Bodies::add(const NewBody& body, const Shape& bodyShape, Turning ofBalls) {
  const MassProperties& unit = bodyShape.massProperties();
  const Vec3 moments = body.density * unit.inertia;
  const Turning turns = turningOf(bodyShape, moments, ofBalls);
  const Quat lies = turns == Turning::ball ? Quat::Identity() : body.pose.q.normalized();
  turning.push_back(turns);
  const bool upright = staysUpright(bodyShape, turns);
  if (!upright) makeOrientations();
  if (!upright || !q.empty()) {
    q.push_back(lies);
    qHalf.push_back(lies);
    frame.emplace_back(Pose{body.pose.x, lies});
  }
  x.push_back(body.pose.x);
  v.push_back(freeTranslation(body.locks, body.velocity));
  w.push_back(freeRotation(body.locks, body.spin));
  vHalf.push_back(v.back());
  wHalf.push_back(turns == Turning::byScheme ? lies.conjugate() * w.back() : w.back());
  spinHalf.push_back(w.back());
  acceleration.push_back(Vec3::Zero());
  alpha.push_back(Vec3::Zero());
  force.push_back(Vec3::Zero());
  torque.push_back(Vec3::Zero());
  travel.push_back(0);

  mass.push_back(body.density * unit.volume);
  inverseMass.push_back(1 / mass.back());
  inertia.push_back(moments);
  inverseInertia.push_back(inertia.back().cwiseInverse());
  // S 13 with its averages over the surface: <r^2>/<I>, <I> the mean principal moment.
  radiusRatio.push_back(unit.meanSquareRadius / inertia.back().mean());
  boundingRadius.push_back(bodyShape.boundingRadius());
  shape.push_back(&bodyShape);
  shapeIndex.push_back(body.shapeIndex);
  material.push_back(body.material);
  id.push_back(body.id);
  state.push_back(BodyState::moving);
  locks.push_back(body.locks);
  aloft.push_back(0);
  someLocked = someLocked || body.locks != 0;
  noteChange();
  return size() - 1;
}

void Bodies::hold(std::size_t i, BodyState as) {
  state[i] = as;
  noteChange();
  v[i] = w[i] = vHalf[i] = wHalf[i] = spinHalf[i] = acceleration[i] = alpha[i] = Vec3::Zero();
  if (haveOrientations()) qHalf[i] = q[i];
  // A sleeping body stays as light as it is: its neighbours must feel the same contact as before.
  if (as == BodyState::frozen) {
    inverseMass[i] = 0;
    inverseInertia[i] = Vec3::Zero();
    radiusRatio[i] = 0;
  }
}

void Bodies::release(std::size_t i) {
  state[i] = BodyState::moving;
  noteChange();
  inverseMass[i] = 1 / mass[i];
  inverseInertia[i] = inertia[i].cwiseInverse();
  radiusRatio[i] = shape[i]->massProperties().meanSquareRadius / inertia[i].mean();
}

void Bodies::rearrange(const std::vector<std::int32_t>& order) {
  const auto lay = [&](auto& column) {
    if (!column.empty()) column = pick(column, order);
  };
  visitState([&](const char*, auto& column) { lay(column); });
  lay(frame);
  lay(boundingRadius);
  lay(shape);
  lay(turning);
  lay(aloft);
  dropNeedlessOrientations();
  noteChange();
}

void Bodies::takeOff(const std::vector<std::int32_t>& slots) {
  for (const std::int32_t slot : slots) aloft[static_cast<std::size_t>(slot)] = 1;
  someAloft = !slots.empty();
  listStale = true;
}

void Bodies::land() {
  for (const std::int32_t slot : listMoving().flying.all) aloft[static_cast<std::size_t>(slot)] = 0;
  someAloft = false;
  listStale = true;
}

std::vector<std::int32_t> Bodies::slotsById() const {
  std::vector<std::int32_t> slots(size());
  std::iota(slots.begin(), slots.end(), 0);
  std::sort(slots.begin(), slots.end(), [&](std::int32_t i, std::int32_t j) {
    return id[static_cast<std::size_t>(i)] < id[static_cast<std::size_t>(j)];
  });
  return slots;
}

const Bodies::MovingList& Bodies::listMoving() const {
  if (!listStale) return listed;
  for (MovingSlots* slots : {&listed.stepped, &listed.flying}) {
    for (auto* some : {&slots->all, &slots->byScheme, &slots->balls, &slots->orientedBalls}) some->clear();
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (!moves(i)) continue;
    const auto slot = static_cast<std::int32_t>(i);
    MovingSlots& slots = aloft[i] != 0 ? listed.flying : listed.stepped;
    slots.all.push_back(slot);
    (isBall(i) ? slots.balls : slots.byScheme).push_back(slot);
    if (turning[i] == Turning::ballWithOrientation) slots.orientedBalls.push_back(slot);
  }
  listStale = false;
  return listed;
}

void Bodies::restoreDerived(const ShapeTable& shapes, Turning ofBalls) {
  const std::size_t n = x.size();
  boundingRadius.resize(n);
  shape.resize(n);
  turning.resize(n);
  aloft.assign(n, 0);
  someAloft = false;
  for (std::size_t i = 0; i < n; ++i) {
    shape[i] = shapes[static_cast<std::size_t>(shapeIndex[i])].get();
    turning[i] = turningOf(*shape[i], inertia[i], ofBalls);
    boundingRadius[i] = shape[i]->boundingRadius();
    someLocked = someLocked || locks[i] != 0;
  }
  makeOrientations();
  frame.clear();
  for (std::size_t i = 0; i < n; ++i) {
    if (turning[i] == Turning::ball) q[i] = qHalf[i] = noTurn;
    frame.emplace_back(poseOf(i));
  }
  dropNeedlessOrientations();
  noteChange();
}

}  // namespace granular
