#include "granular/body/bodies.h"

#include <algorithm>
#include <numeric>

#include "granular/core/pick.h"

namespace granular {

void Bodies::reserve(std::size_t count) {
  visitState([&](const char*, auto& column) { column.reserve(count); });
  frame.reserve(count);
  boundingRadius.reserve(count);
  shape.reserve(count);
  turning.reserve(count);
  aloft.reserve(count);
}

std::size_t Bodies::add(const NewBody& body, const Shape& bodyShape) {
  const MassProperties& unit = bodyShape.massProperties();
  x.push_back(body.pose.x);
  q.push_back(body.pose.q.normalized());
  v.push_back(freeTranslation(body.locks, body.velocity));
  w.push_back(freeRotation(body.locks, body.spin));
  vHalf.push_back(v.back());
  wHalf.push_back(q.back().conjugate() * w.back());
  qHalf.push_back(q.back());
  spinHalf.push_back(w.back());
  acceleration.push_back(Vec3::Zero());
  alpha.push_back(Vec3::Zero());
  frame.emplace_back(Pose{x.back(), q.back()});
  force.push_back(Vec3::Zero());
  torque.push_back(Vec3::Zero());
  travel.push_back(0);

  mass.push_back(body.density * unit.volume);
  inverseMass.push_back(1 / mass.back());
  inertia.push_back(body.density * unit.inertia);
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
  turning.push_back(Turning::byScheme);
  aloft.push_back(0);
  someLocked = someLocked || body.locks != 0;
  noteChange();
  return size() - 1;
}

void Bodies::turnAsBall(std::size_t i, bool keepsOrientation) {
  const Vec3& moments = inertia[i];
  if (!shape[i]->isRound() || moments.x() != moments.y() || moments.y() != moments.z()) return;
  turning[i] = keepsOrientation ? Turning::ballWithOrientation : Turning::ball;
  noteChange();
  if (keepsOrientation) return;
  q[i] = qHalf[i] = Quat::Identity();
  frame[i] = Frame(Pose{x[i], q[i]});
}

void Bodies::hold(std::size_t i, BodyState as) {
  state[i] = as;
  noteChange();
  v[i] = w[i] = vHalf[i] = wHalf[i] = spinHalf[i] = acceleration[i] = alpha[i] = Vec3::Zero();
  qHalf[i] = q[i];
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
  const auto lay = [&](auto& column) { column = pick(column, order); };
  visitState([&](const char*, auto& column) { lay(column); });
  lay(frame);
  lay(boundingRadius);
  lay(shape);
  lay(turning);
  lay(aloft);
  noteChange();
}

void Bodies::takeOff(const std::vector<std::int32_t>& slots) {
  for (const std::int32_t slot : slots) aloft[static_cast<std::size_t>(slot)] = 1;
  listStale = true;
}

void Bodies::land() {
  for (const std::int32_t slot : listMoving().flying.all) aloft[static_cast<std::size_t>(slot)] = 0;
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

void Bodies::restoreDerived(const ShapeTable& shapes) {
  const std::size_t n = x.size();
  frame.resize(n);
  boundingRadius.resize(n);
  shape.resize(n);
  turning.assign(n, Turning::byScheme);
  aloft.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    shape[i] = shapes[static_cast<std::size_t>(shapeIndex[i])].get();
    frame[i] = Frame(Pose{x[i], q[i]});
    boundingRadius[i] = shape[i]->boundingRadius();
    someLocked = someLocked || locks[i] != 0;
  }
  noteChange();
}

}  // namespace granular
