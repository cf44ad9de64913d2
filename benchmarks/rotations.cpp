// Error against run time of rotation schemes on tops that are known exactly: free, damped, heavy, and heavy under a
// torque of the velocity. Writes one line per scheme, top and step (CSV); asserts nothing.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <fstream>

#include "demos/exit_code.h"
#include "granular/core/errors.h"
#include "integrate/exact_tops.h"
#include "rotation_rivals.h"

namespace {

using namespace granular;

/// A motion that is known: its moments, torque (of q, w and t, world axes), and state at any time.
struct FreeCase {
  static constexpr const char* name = "free";
  FreeTop top{0.8, 1.1};
  Vec3 inertia = top.inertia;
  double duration = 20;
  Vec3 torque(const Quat&, const Vec3&, double) const { return Vec3::Zero(); }
  Quat orientation(double t) const { return top.orientation(t); }
  Vec3 velocity(double t) const { return top.orientation(t) * top.velocityBody(t); }
};

/// Torque -c I w: the free motion at the time s = (1 - exp(-c t))/c, slower by exp(-c t).
struct DampedCase {
  static constexpr const char* name = "damped";
  FreeTop top{0.8, 1.1};
  Vec3 inertia = top.inertia;
  double duration = 20, rate = 0.1;
  Vec3 torque(const Quat& q, const Vec3& w, double) const {
    return -rate * (q * inertia.cwiseProduct(q.conjugate() * w));
  }
  double stretched(double t) const { return (1 - std::exp(-rate * t)) / rate; }
  Quat orientation(double t) const { return top.orientation(stretched(t)); }
  Vec3 velocity(double t) const { return std::exp(-rate * t) * (orientation(t) * top.velocityBody(stretched(t))); }
};

struct HeavyCase {
  static constexpr const char* name = "heavy";
  HeavyTop top;
  Vec3 inertia = top.inertia;
  double duration = 20;
  Vec3 torque(const Quat& q, const Vec3&, double) const { return top.torque(q); }
  Quat orientation(double t) const { return top.orientation(t); }
  Vec3 velocity(double t) const { return top.velocity(t); }
};

/// The same with a dashpot between the body and a frame that moves as it should: no torque on the exact motion, but
/// half a step's change of the velocity, taken for the velocity at t_n, is felt in first order.
struct HeldCase : HeavyCase {
  static constexpr const char* name = "heavy dashpot";
  double rate = 0.1;
  Vec3 torque(const Quat& q, const Vec3& w, double t) const {
    return HeavyCase::torque(q, w, t) - rate * inertia.mean() * (w - velocity(t));
  }
};

struct Result {
  double orientation = 0;  ///< largest angle from the exact orientation, rad
  double velocity = 0;     ///< largest error of w over |w|
  double nsPerStep = 0;    ///< of processor time
};

double processorTime() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Runs the case in the given number of steps and compares at eight times. timed: takes the time alone.
template <class Scheme, class Case>
Result run(const Scheme& fresh, const Case& motion, int steps, bool timed) {
  Scheme scheme = fresh;
  const double dt = motion.duration / steps;
  Quat q = motion.orientation(0);
  Vec3 w = motion.velocity(0);
  // The torque's time is that of the state it is asked for: whole steps, and where there are two a step its middle.
  int asked = 0;
  const auto torque = [&](const Quat& at, const Vec3& turning) {
    return motion.torque(at, turning, asked++ * dt / Scheme::torques);
  };
  scheme.start(dt, motion.inertia, torque, q, w);
  Result result;
  const double began = processorTime();
  for (int n = 1; n <= steps; ++n) {
    scheme.step(dt, torque, q, w);
    if (timed || n % (steps / 8) != 0) continue;
    const double t = n * dt;
    const Vec3 exact = motion.velocity(t);
    result.orientation = std::max(result.orientation, q.angularDistance(motion.orientation(t)));
    result.velocity = std::max(result.velocity, (w - exact).norm() / exact.norm());
  }
  result.nsPerStep = 1e9 * (processorTime() - began) / steps;
  // Keeps the timed loop from being optimised away.
  if (timed && !(q.norm() > 0)) std::printf("?");
  return result;
}

template <class Scheme, class Case>
void study(const char* name, const Scheme& scheme, const Case& motion, std::ostream& out) {
  const double spin = motion.velocity(0).norm();
  // The cost of a step does not depend on its length; the least of three counts.
  double cost = infinity;
  for (int k = 0; k < 3; ++k) cost = std::min(cost, run(scheme, motion, 40000, true).nsPerStep);
  for (double turn = 1; turn > 1.5e-3; turn /= 2) {
    const int steps = 8 * static_cast<int>(std::ceil(spin * motion.duration / turn / 8));
    const Result r = run(scheme, motion, steps, false);
    char line[256];
    std::snprintf(line, sizeof line, "%s,%s,%d,%.6g,%.6g,%d,%.6g,%.6g,%.4g,%.6g\n", motion.name, name, Scheme::torques,
                  motion.duration / steps, spin * motion.duration / steps, steps, r.orientation, r.velocity, cost,
                  1e-9 * cost * steps / motion.duration);
    out << line;
  }
}

template <class Case>
void studyAll(const Case& motion, std::ostream& out) {
  using Mode = BulletScheme::Mode;
  study("Seelen", LibraryScheme(SchemeKind::seelen), motion, out);
  study("SPIRAL leapfrog", LibraryScheme(SchemeKind::spiral), motion, out);
  study("PCDM", PredictorCorrector(), motion, out);
  study("symplectic splitting", Splitting(), motion, out);
  study("Bullet without gyroscopic term", BulletScheme(Mode::none), motion, out);
  study("Bullet explicit", BulletScheme(Mode::explicitForce), motion, out);
  study("Bullet implicit world", BulletScheme(Mode::implicitWorld), motion, out);
  study("Bullet implicit body", BulletScheme(Mode::implicitBody), motion, out);
}

int parseAndRun(int argc, char** argv) {
  CLI::App app{"Rotation schemes on exact tops: error and run time over the step."};
  std::string path;
  app.add_option("--csv", path, "write the table here")->required();
  CLI11_PARSE(app, argc, argv);
  std::ofstream out(path);
  require(out.good(), "can't write " + path);
  out << "top,scheme,torques_per_step,dt_s,turn_per_step_rad,steps,orientation_error_rad,velocity_error,ns_per_step,"
         "run_s_per_s\n";
  studyAll(FreeCase{}, out);
  studyAll(DampedCase{}, out);
  studyAll(HeavyCase{}, out);
  studyAll(HeldCase{}, out);
  out.flush();
  require(out.good(), "can't write " + path);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("rotations", [&] { return parseAndRun(argc, argv); });
}
