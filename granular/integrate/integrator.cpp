#include "granular/integrate/integrator.h"

#include <array>
#include <string>

#include "granular/core/errors.h"
#include "granular/integrate/seelen.h"
#include "granular/integrate/spiral.h"

namespace granular {
namespace {

// The table of schemes: one row per scheme, in the order of SchemeKind.
constexpr std::array<RotationScheme, 2> schemes = {{
    {SchemeKind::seelen, "seelen", seelen::startRotation, seelen::predictRotation, seelen::advanceRotation},
    {SchemeKind::spiral, "spiral", spiral::startRotation, spiral::predictRotation, spiral::advanceRotation},
}};

}  // namespace

const RotationScheme& rotationScheme(SchemeKind kind) { return schemes[static_cast<std::size_t>(kind)]; }

SchemeKind schemeFromName(std::string_view name) {
  for (const RotationScheme& row : schemes) {
    if (row.name == name) return row.kind;
  }
  std::string known;
  for (const RotationScheme& row : schemes) known += " \"" + std::string(row.name) + "\"";
  throw InputError("unknown integration scheme \"" + std::string(name) + "\"; known:" + known);
}

}  // namespace granular
