// Error against run time of single impacts that are known exactly: (a) spheres that slide on the floor, (b)
// frictionless bodies that hit it off their centre, under every contact-point rule, (c) the linear dashpot; over the
// step and, for (b), the stiffness. Worst of several phases of first contact. Writes one line per case, rule, stiffness
// and step (CSV); asserts nothing.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>

#include "demos/exit_code.h"
#include "granular/core/errors.h"
#include "verification/impact_scenes.h"

namespace {

using namespace granular;

constexpr std::array<double, 6> stepsPerContact = {10, 20, 40, 80, 160, 320};
constexpr std::array<double, 4> phases = {0.05, 0.3, 0.55, 0.8};

double processorTime() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One line: the worst error over the phases, and the processor's time for one of them.
template <class ErrorOf>
void write(std::ostream& out, const char* name, std::string_view rule, double stiffness, double steps,
           const ErrorOf& errorOf) {
  double worst = 0;
  const double began = processorTime();
  for (const double phase : phases) worst = std::max(worst, errorOf(phase));
  const double cost = (processorTime() - began) / phases.size();
  char line[256];
  std::snprintf(line, sizeof line, "%s,%s,%.6g,%.6g,%.6g,%.6g\n", name, std::string(rule).c_str(), stiffness, steps,
                worst, cost);
  out << line;
}

/// (a) Chung & Ooi's test 4 at 45 degrees: it slides throughout, and the spin is 5/2 mu (1 + e) v_n/R.
void studySliding(std::ostream& out) {
  const double speed = 3.9 * std::sqrt(.5);
  for (const double steps : stepsPerContact) {
    write(out, "sliding sphere: spin", "-", 0, steps, [&](double phase) {
      SphereImpact impact{2.5e-3, speed, speed, 0, .092, .98};
      impact.run({PointRule::patch, LawKind::linear, steps, phase});
      const double exact = 2.5 * .092 * 1.98 * speed / 2.5e-3;
      return std::abs(impact.turning.y() / exact - 1);
    });
  }
}

/// (b) A body that hits the floor off its centre, e = 1: error of the rebound speed, over the speed of 1 m/s.
void studyRebound(std::ostream& out, const char* name, const std::shared_ptr<const Shape>& shape, double tilt,
                  double offset, double moment) {
  const FrozenContact exact = solveFrozenContact(1, offset, moment);
  for (const PointRule rule : {PointRule::witness, PointRule::faceCentroid, PointRule::pressureCentroid,
                               PointRule::patch, PointRule::stiffPatch, PointRule::foundation}) {
    for (const double stiffness : {1e5, 1e7, 1e9}) {
      for (const double steps : stepsPerContact) {
        write(out, name, pointRuleName(rule), stiffness, steps, [&](double phase) {
          const Rebound got =
              dropOnFloor(shape, tiltedBy(tilt), {stiffness, 1, 1, 0}, false, {rule, LawKind::linear, steps, phase});
          return std::abs(got.velocity - exact.velocity);
        });
      }
    }
  }
}

void studyRebounds(std::ostream& out) {
  const double tilt = pi / 4;
  studyRebound(out, "cylinder 45 deg: v_z'", TiltedCylinder::make(), tilt, TiltedCylinder::offset(tilt),
               TiltedCylinder::moment);
  // Long axis at 15 degrees from the floor; turned about y, the offset is (a^2 - b^2) sin t cos t/h.
  const double a = 4e-3, b = 2e-3, t = pi / 12, s = std::sin(t), c = std::cos(t);
  const double height = std::sqrt(a * a * s * s + b * b * c * c);
  studyRebound(out, "ellipsoid 2:1 15 deg: v_z'", makeShape("ellipsoid", std::vector{a, b, b}), t,
               (a * a - b * b) * s * c / height, (a * a + b * b) / 5);
  // A cube on its edge, 30 degrees from lying: its lowest edge is off the centre by half (cos - sin).
  const double half = 1.5e-3, turn = pi / 6;
  studyRebound(out, "cube edge 30 deg: v_z'", cuboidOf(Vec3::Constant(half)), turn,
               half * (std::cos(turn) - std::sin(turn)), 2 * half * half / 3);
}

/// (c) Restitution of the dashpot, kept to its attractive end or cut at zero.
void studyDashpots(std::ostream& out) {
  for (const bool tension : {true, false}) {
    for (const double e : {.8, .5}) {
      char name[64];
      std::snprintf(name, sizeof name, "dashpot %s: e = %.1f", tension ? "with attraction" : "cut at zero", e);
      for (const double steps : stepsPerContact) {
        const double dt = DashpotBounce::contactTime(e, tension) / steps;
        write(out, name, "-", DashpotBounce::stiffness, steps,
              [&](double phase) { return std::abs(DashpotBounce::run(e, tension, dt, phase).restitution - e); });
      }
    }
  }
}

int parseAndRun(int argc, char** argv) {
  CLI::App app{"Single impacts: error and run time over step, stiffness and contact-point rule."};
  std::string path;
  app.add_option("--csv", path, "write the table here")->required();
  CLI11_PARSE(app, argc, argv);
  std::ofstream out(path);
  require(out.good(), "can't write " + path);
  out << "case,rule,stiffness_n_per_m,steps_per_contact,error,processor_s\n";
  studySliding(out);
  studyRebounds(out);
  studyDashpots(out);
  out.flush();
  require(out.good(), "can't write " + path);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("impacts", [&] { return parseAndRun(argc, argv); });
}
