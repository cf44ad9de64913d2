// (c) The linear dashpot: damping ratio for a restitution, duration, and what the step costs.
#include <fmt/format.h>

#include "verification/impact_scenes.h"
#include "verification/record.h"

namespace granular {
namespace {

TEST(Dashpot, DampingRatiosAreTheOnesOfTheClosedForms) {
  const double rows[][3] = {
      {.9, .03352, .03427}, {.7, .11281, .12221}, {.5, .21545, .25528}, {.3, .35786, .49724}, {.1, .59116, 1.24319}};
  for (const auto& [e, pulling, cut] : rows) {
    verify('c', fmt::format("zeta for e = {}, with attraction", e), pulling, dampingRatioFor(e, true), 5.1e-6,
           "closed form, five digits");
    verify('c', fmt::format("zeta for e = {}, no tension", e), cut, dampingRatioFor(e, false), 5.1e-6,
           "closed form, five digits");
  }
  verify('c', "zeta for e = exp(-2), no tension", 1, dampingRatioFor(std::exp(-2), false), 1e-7,
         "closed form, limit of acos and acosh");
}

TEST(Dashpot, SimulatedContactHasTheRestitutionAndDurationAskedFor) {
  for (const bool tension : {true, false}) {
    for (const double e : {.9, .7, .5, .3, .1}) {
      const double time = DashpotBounce::contactTime(e, tension), dt = time / 2000;
      const DashpotBounce got = DashpotBounce::run(e, tension, dt, 0.5);
      const std::string name = fmt::format("e = {}, {}", e, tension ? "with attraction" : "no tension");
      // Cut at zero: the force jumps by 2 zeta at the ends, first order in the step; otherwise at its start alone.
      verify('c', name + ": restitution at t_c/2000", e, got.restitution, 0.8 / 2000,
             "closed form; order 1 of the step");
      if (!tension)
        verify('c', name + ": duration of push / t_c", 1, got.duration / time, 2.0 / 2000,
               "closed form; one step at each end");
    }
  }
}

/// Largest error over the phase of first contact.
double worstError(double e, bool tension, double steps) {
  double worst = 0;
  const double dt = DashpotBounce::contactTime(e, tension) / steps;
  for (int phase = 0; phase < 40; ++phase)
    worst = std::max(worst, std::abs(DashpotBounce::run(e, tension, dt, (phase + 0.5) / 40).restitution - e));
  return worst;
}

TEST(Dashpot, StepErrorsAreTheKnownOnes) {
  struct Case {
    double e;
    bool tension;
    double steps, error;
  };
  const Case cases[] = {{1, true, 10, 1.9e-3}, {1, true, 20, 2.4e-4},    {1, true, 50, 1.6e-5},
                        {1, true, 100, 2e-6},  {.5, false, 10, 4.5e-2},  {.5, false, 20, 2e-2},
                        {.5, false, 50, 7e-3}, {.5, false, 100, 3.5e-3}, {.9, true, 50, 2.2e-4}};
  for (const Case& c : cases) {
    // Two digits are given, and the worst of finitely many phases is a little less: a tenth above.
    verifyBelow(
        'c',
        fmt::format("e = {}, {}, t_c/{}: worst error of e", c.e, c.tension ? "with attraction" : "no tension", c.steps),
        1.1 * c.error, worstError(c.e, c.tension, c.steps), "independent computation, two digits, and a tenth");
  }
}

}  // namespace
}  // namespace granular
