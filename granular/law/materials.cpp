#include "granular/law/materials.h"

#include <algorithm>
#include <cmath>

#include "granular/core/errors.h"

namespace granular {
namespace {

/// prepareLaw, with the owner's name before its message.
LawConstants prepareFor(const std::string& owner, const ContactParameters& parameters) {
  try {
    return prepareLaw(parameters);
  } catch (const InputError& error) {
    throw InputError(owner + ": " + error.what());
  }
}

}  // namespace

ContactParameters mixParameters(const ContactParameters& a, const ContactParameters& b) {
  ContactParameters mixed;
  // 2/(1/a + 1/b) and sqrt(a b) need not give back a = b to the last bit: keep equal values as they are.
  const auto mixGeometric = [](double x, double y) { return x == y ? x : std::sqrt(x) * std::sqrt(y); };
  const auto mixInSeries = [](double x, double y) { return x == y ? x : x > 0 && y > 0 ? 2 / (1 / x + 1 / y) : 0; };
  mixed.stiffness = mixInSeries(a.stiffness, b.stiffness);
  mixed.restitution = std::min(mixGeometric(a.restitution, b.restitution), 1.0);
  mixed.restitutionT = std::min(mixGeometric(a.restitutionT, b.restitutionT), 1.0);
  mixed.friction = mixGeometric(a.friction, b.friction);
  // Compliances add: 1/E* of unequal solids is half the sum of those of equal ones.
  mixed.modulus = mixInSeries(a.modulus, b.modulus);
  mixed.shearModulus = mixInSeries(a.shearModulus, b.shearModulus);
  mixed.dampingRateN = mixGeometric(a.dampingRateN, b.dampingRateN);
  mixed.dampingRateT = mixGeometric(a.dampingRateT, b.dampingRateT);
  for (std::size_t k = 0; k < mixed.own.size(); ++k) mixed.own[k] = 0.5 * (a.own[k] + b.own[k]);
  return mixed;
}

int MaterialTable::add(std::string_view name, const ContactParameters& parameters) {
  require(!name.empty(), "a material needs a name");
  const std::string owner(name);
  require(std::find(names.begin(), names.end(), owner) == names.end(), "material \"" + owner + "\" is defined twice");
  const LawConstants constantsOfOwn = prepareFor("material \"" + owner + "\"", parameters);

  // Grow the flat table by one row and column.
  const int old = count();
  std::vector<LawConstants> grown(static_cast<std::size_t>((old + 1) * (old + 1)));
  for (int i = 0; i < old; ++i) {
    for (int j = 0; j < old; ++j) grown[static_cast<std::size_t>(i * (old + 1) + j)] = constants(i, j);
  }
  pairs = std::move(grown);
  names.push_back(owner);
  own.push_back(parameters);

  // Its own pair, and the mixture with every material before it.
  write(old, old, constantsOfOwn);
  for (int i = 0; i < old; ++i) write(i, old, prepareLaw(mixParameters(own[static_cast<std::size_t>(i)], parameters)));
  return old;
}

void MaterialTable::setPair(std::string_view first, std::string_view second, const ContactParameters& parameters) {
  const int i = find(first), j = find(second);
  write(i, j, prepareFor("materials \"" + name(i) + "\" and \"" + name(j) + "\"", parameters));
}

int MaterialTable::find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  std::string known;
  for (const std::string& each : names) known += " \"" + each + "\"";
  throw InputError("unknown material \"" + std::string(name) + "\"; known:" + known);
}

void MaterialTable::write(int i, int j, const LawConstants& constantsOfPair) {
  pairs[static_cast<std::size_t>(i * count() + j)] = constantsOfPair;
  pairs[static_cast<std::size_t>(j * count() + i)] = constantsOfPair;
}

}  // namespace granular
