// The scene of a pile.
#include <fmt/format.h>

#include "granular/core/errors.h"
#include "granular/io/output_file.h"
#include "granular/run/pile.h"
#include "granular/shape/ellipsoid_chain.h"

namespace granular {
namespace {

void requirePositive(const char* name, double value) {
  require(std::isfinite(value) && value > 0, fmt::format("{} = {:g}: must be finite and > 0", name, value));
}

std::string formatParticles(const PileSettings& s) {
  std::string text = "[[particles]]\n";
  if (s.shape == PileSettings::Shape::ellipsoid) {
    text += fmt::format("shape = \"ellipsoid\"\nsemi_axes = [{0}, {1}, {1}]\n", s.halfLength, s.halfWidth);
  } else {
    text += fmt::format(
        "shape = \"clump\"\nconstruction = \"ellipsoid\"\nhalf_length = {}\nhalf_width = {}\nspheres = {}\n"
        "mass = \"smooth\"\n",
        s.halfLength, s.halfWidth, s.spheres);
  }
  text += fmt::format("count = {}\n", s.count);
  if (!s.space) text += "lock_translation = \"y\"\nlock_rotation = [\"x\", \"z\"]\n";
  return text;
}

/// Of the hopper: where it is filled, and how wide it is there.
double fillHeight(const PileSettings& s) { return s.outlet + 4 * s.orifice; }
double hopperRadius(const PileSettings& s) { return 1.5 * s.orifice; }

std::string formatInsertion(const PileSettings& s) {
  std::string text = fmt::format("[insertion]\nkind = \"drop\"\nrate = {}\n", 1 / s.interval);
  if (s.space) {
    const double half = 0.5 * hopperRadius(s) - s.halfLength;
    return text + fmt::format("from = [{0}, {0}, {2}]\nto = [{1}, {1}, {3}]\nturn = \"any\"\n", -half, half,
                              fillHeight(s) - s.orifice, fillHeight(s));
  }
  const double first = s.halfLength + 1e-8;  // M: 1e-5 mm
  return text + fmt::format("from = [{}, 0, {}]\nto = [{}, 0, {}]\nturn = \"y\"\n", first, s.height, first + s.spread,
                            s.height);
}

}  // namespace

void checkPile(const PileSettings& s) {
  require(s.count >= 1 && s.count <= 1000000, fmt::format("count = {}: must be 1 to 1000000", s.count));
  require(s.seed >= 0, fmt::format("seed = {}: must be >= 0", s.seed));
  for (const auto& [name, value] : {std::pair{"half_length", s.halfLength},
                                    {"half_width", s.halfWidth},
                                    {"height", s.height},
                                    {"interval", s.interval},
                                    {"orifice", s.orifice},
                                    {"outlet", s.outlet}})
    requirePositive(name, value);
  require(s.sleep >= 0 && s.sleep < 1, fmt::format("sleep = {:g}: must be >= 0 and < 1", s.sleep));
  require(s.space || s.height > s.halfLength,
          fmt::format("height = {:g} m: must be above the half length {:g} m", s.height, s.halfLength));
  require(!s.space || s.orifice >= 3 * s.halfLength,
          fmt::format("orifice = {:g} m: a particle {:g} m long does not run through; at least {:g} m", s.orifice,
                      2 * s.halfLength, 3 * s.halfLength));
  // Throws for an N that the construction does not have.
  if (s.shape == PileSettings::Shape::clump)
    makeEllipsoidChain(s.halfLength, s.halfWidth, static_cast<int>(std::min<std::int64_t>(s.spheres, 100001)));
}

double expectedOverlap(const PileSettings& s) {
  // (15 m v^2/(16 E* sqrt(R)))^(2/5), v^2 = 2 g h, R at the waist, on the floor.
  const double square = 2 * 9.81 * (s.space ? fillHeight(s) : s.height);
  const double modulus = s.young / (2 * (1 - s.poisson * s.poisson));
  const double overlap = std::pow(15 * s.mass * square / (16 * modulus * std::sqrt(s.halfLength)), 0.4);
  return overlap / std::cbrt(s.halfLength * s.halfWidth * s.halfWidth);
}

std::string formatPileScene(const PileSettings& s) {
  checkPile(s);
  const double volume = 4.0 / 3 * pi * s.halfLength * s.halfWidth * s.halfWidth;
  std::string text = fmt::format("name = \"pile\"\nseed = {}\nthreads = 1\n[vessel]\nkind = \"none\"\n", s.seed);
  text += "[[wall]]\nkind = \"plane\"\nname = \"floor\"\nnormal = [0, 0, 1]\n";
  if (s.space) {
    text += "[[wall]]\nkind = \"mesh\"\nname = \"hopper\"\nfile = \"hopper.obj\"\nunit = \"m\"\n";
  } else {
    text += "[[wall]]\nkind = \"plane\"\nname = \"side\"\nnormal = [1, 0, 0]\n";
  }
  text += "[model]\nlaw = \"hertz\"\npoint_rule = \"witness\"\n";
  text += fmt::format("[[material]]\nname = \"grain\"\ndensity = {}\nyoung_modulus = {}\npoisson_ratio = {}\n",
                      s.mass / volume, s.young, s.poisson);
  text += fmt::format("[contact_default]\nfriction = {}\ndamping_normal = {}\ndamping_tangential = {}\n", s.friction,
                      s.damping, s.damping);
  // As many contacts at once as a particle of the pile has on average; the bound of those met is watched during the
  // run.
  text += fmt::format("[time]\noverlap = {}\ncontacts = 4\n", expectedOverlap(s));
  if (s.step) text += fmt::format("step = {}\n", *s.step);
  text += formatParticles(s) + formatInsertion(s);
  text +=
      s.sleep > 0 ? fmt::format("[settle]\nkind = \"sleep\"\nenergy = {}\n", s.sleep) : "[settle]\nkind = \"none\"\n";
  text += fmt::format("[rest]\nenergy = 1e-6\ntime = 0.1\nmax_time = {}\n", s.rest);
  text += "[output]\nstl = false\nglb = false\nplots = false\ncheckpoint_every = 60\n";
  return text;
}

void writeHopper(const PileSettings& s, const std::filesystem::path& folder) {
  // Rings of 48 points around a section of the wall: up the inside, down the outside. Thicker than a particle is wide,
  // so that one that jumps against it from outside is not taken for one inside.
  constexpr int around = 48;
  const double narrow = 0.5 * s.orifice, wide = hopperRadius(s), thick = 2 * s.halfLength;
  const double joint = s.outlet + std::sqrt(3.0) * (wide - narrow);
  const double rim = std::max(joint, fillHeight(s)) + 2 * s.orifice;
  const std::pair<double, double> rings[] = {{narrow, s.outlet},  {wide, joint},         {wide, rim},
                                             {wide + thick, rim}, {wide + thick, joint}, {narrow + thick, s.outlet}};
  constexpr int count = std::size(rings);
  std::string text;
  for (const auto& [radius, z] : rings) {
    for (int k = 0; k < around; ++k) {
      const double azimuth = 2 * pi * k / around;
      text += fmt::format("v {} {} {}\n", radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    }
  }
  // Wound so that normals point away from the wall; OBJ counts from 1.
  for (int ring = 0; ring < count; ++ring) {
    const int up = (ring + 1) % count * around - ring * around;
    for (int k = 0; k < around; ++k) {
      const int a = ring * around + k + 1, b = ring * around + (k + 1) % around + 1;
      text += fmt::format("f {} {} {}\nf {} {} {}\n", a, a + up, b, b, a + up, b + up);
    }
  }
  OutputFile file(folder / "hopper.obj");
  file.write(text);
  file.finish();
}

}  // namespace granular
