// Chains of spheres against the ellipsoids they stand for: relative area and perimeter of the section, relative volume
// (Markauskas et al. 2010, fig. 5). Writes one line per aspect ratio and number of spheres (CSV), without those whose
// chain has gaps; plots/plot_chains.py draws them.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <vector>

#include "demos/exit_code.h"
#include "granular/core/errors.h"
#include "granular/io/output_file.h"
#include "granular/shape/ellipsoid_chain.h"

namespace {

int parseAndRun(int argc, char** argv) {
  CLI::App app("Chains of spheres against the ellipsoids they stand for.");
  std::vector<double> aspects{1.5, 2.35, 5, 10};
  int most = 55;
  std::string out;
  app.add_option("--aspects", aspects, "length over width of the ellipsoids (default 1.5 2.35 5 10)");
  app.add_option("--most", most, "spheres of a chain (default 55)");
  app.add_option("--out", out, "CSV file")->required();
  CLI11_PARSE(app, argc, argv);
  for (const double aspect : aspects) granular::require(aspect > 1, "--aspects: each must be above 1");
  granular::OutputFile file(out);
  file.write("aspect,spheres,area,perimeter,volume\n");
  for (const double aspect : aspects) {
    for (int count = 3; count <= most; count += 2) {
      if (count > 3 && count < granular::smallestChain(aspect, 1)) continue;
      const auto quality = granular::measureChain(granular::makeEllipsoidChain(aspect, 1, count), aspect, 1);
      char line[160];
      std::snprintf(line, sizeof line, "%.17g,%d,%.17g,%.17g,%.17g\n", aspect, count, quality.area, quality.perimeter,
                    quality.volume);
      file.write(line);
    }
  }
  file.finish();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("chains", [&] { return parseAndRun(argc, argv); });
}
