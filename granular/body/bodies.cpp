#include "granular/body/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "granular/core/errors.h"
#include "granular/core/pick.h"
#include "granular/core/room.h"

namespace granular {

template <class Visitor>
void Bodies::visitColumns(Visitor&& visit) {
  visit(bounds);
  visit(motion);
  for (auto* column : {&acceleration, &alpha, &force, &torque}) visit(*column);
  for (auto* column : {&travel, &mass}) visit(*column);
  visit(shape);
  for (auto* column : {&shapeIndex, &material}) visit(*column);
  visit(id);
  visit(state);
  visit(locks);
  visit(turning);
  visit(aloft);
}

template <class Visitor>
void Bodies::visitColumnsOfSome(Visitor&& visit) {
  for (auto* column : {&q, &qHalf}) visit(*column);
  visit(frame);
  for (auto* column : {&wHalf, &inertia, &inverseInertia}) visit(*column);
}

void Bodies::reserve(std::size_t count) {
  visitColumns([&](auto& column) { column.reserve(count); });
  visitColumnsOfSome([&](auto& column) {
    if (!column.empty()) column.reserve(count);
  });
}

Bodies::Turning Bodies::turningOf(const Shape& bodyShape, const Vec3& moments, Turning ofBalls) {
  const bool isBall = bodyShape.isRound() && moments.x() == moments.y() && moments.y() == moments.z();
  return isBall ? ofBalls : Turning::byScheme;
}

void Bodies::makeOrientations() {
  if (!q.empty()) return;
  q.reserve(bounds.capacity());
  qHalf.reserve(bounds.capacity());
  frame.reserve(bounds.capacity());
  q.assign(size(), noTurn);
  qHalf.assign(size(), noTurn);
  frame.clear();
  for (const BoundingSphere& sphere : bounds) frame.emplace_back(Mat3::Identity(), sphere.x);
}

void Bodies::makeTurnColumns() {
  for (auto* column : {&wHalf, &inertia, &inverseInertia}) {
    column->reserve(bounds.capacity());
    column->resize(size());
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (!isBall(i)) continue;
    wHalf[i] = wHalfOf(i);
    inertia[i] = inertiaOf(i);
    inverseInertia[i] = inverseInertiaOf(i);
  }
}

void Bodies::leaveOutNeedless() {
  bool anyScheme = false, anyTurn = false;
  for (std::size_t i = 0; i < size(); ++i) {
    anyScheme = anyScheme || !isBall(i);
    anyTurn = anyTurn || !staysUpright(*shape[i], turning[i]);
  }
  if (!anyScheme) {
    for (auto* column : {&wHalf, &inertia, &inverseInertia}) discard(*column);
  }
  if (anyTurn) return;
  discard(q);
  discard(qHalf);
  discard(frame);
}

void Bodies::resizeRows(const char* name, std::size_t count, std::vector<MotionRow>& rows) {
  require(count == rows.size(),
          fmt::format("checkpoint: world/bodies/{} has {} rows, {} are expected", name, count, rows.size()));
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
  if (turns == Turning::byScheme && wHalf.empty()) makeTurnColumns();
  const Vec3 velocity = freeTranslation(body.locks, body.velocity), spin = freeRotation(body.locks, body.spin);
  if (turns == Turning::byScheme || !wHalf.empty()) {
    wHalf.push_back(lies.conjugate() * spin);
    inertia.push_back(moments);
    inverseInertia.push_back(moments.cwiseInverse());
  }
  const double kilograms = body.density * unit.volume;
  bounds.push_back({body.pose.x, bodyShape.boundingRadius()});
  // S 13 with its averages over the surface: <r^2>/<I>, <I> the mean principal moment.
  motion.push_back(
      {velocity, spin, unit.meanSquareRadius / moments.mean(), 0, velocity, 1 / kilograms, spin, moments.x()});
  acceleration.push_back(Vec3::Zero());
  alpha.push_back(Vec3::Zero());
  force.push_back(Vec3::Zero());
  torque.push_back(Vec3::Zero());
  travel.push_back(0);

  mass.push_back(kilograms);
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
  v(i) = w(i) = vHalf(i) = spinHalf(i) = wHalfOf(i) = acceleration[i] = alpha[i] = Vec3::Zero();
  if (haveOrientations()) qHalf[i] = q[i];
  // A sleeping body stays as light as it is: its neighbours must feel the same contact as before.
  if (as == BodyState::frozen) {
    motion[i].inverseMass = motion[i].radiusRatio = 0;
    if (!isBall(i)) inverseInertia[i] = Vec3::Zero();
  }
}

void Bodies::release(std::size_t i) {
  state[i] = BodyState::moving;
  noteChange();
  motion[i].inverseMass = 1 / mass[i];
  motion[i].radiusRatio = shape[i]->massProperties().meanSquareRadius / inertiaOf(i).mean();
  if (!isBall(i)) inverseInertia[i] = inertia[i].cwiseInverse();
}

void Bodies::rearrange(const std::vector<std::int32_t>& order) {
  visitColumns([&](auto& column) { column = pick(column, order); });
  visitColumnsOfSome([&](auto& column) {
    if (!column.empty()) column = pick(column, order);
  });
  leaveOutNeedless();
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
  const std::size_t n = size();
  shape.resize(n);
  turning.resize(n);
  aloft.assign(n, 0);
  someAloft = false;
  makeOrientations();
  frame.clear();
  for (std::size_t i = 0; i < n; ++i) {
    shape[i] = shapes[static_cast<std::size_t>(shapeIndex[i])].get();
    turning[i] = turningOf(*shape[i], inertia[i], ofBalls);
    bounds[i].radius = shape[i]->boundingRadius();
    motion[i].inertia = inertia[i].x();
    if (isBall(i)) spinHalf(i) = wHalf[i];
    if (turning[i] == Turning::ball) q[i] = qHalf[i] = noTurn;
    frame.emplace_back(poseOf(i));
    someLocked = someLocked || locks[i] != 0;
  }
  leaveOutNeedless();
  noteChange();
}

}  // namespace granular
