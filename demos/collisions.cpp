// Random binary collisions without damping or friction limit: what energy does the contact lose (S table 6)?
#include <omp.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "exit_code.h"
#include "granular/core/errors.h"
#include "granular/io/output_file.h"
#include "granular/run/collision_report.h"

namespace {

struct Options {
  std::vector<std::string> pairs{"all"}, rules{"patch"}, laws{"linear"}, ensembles{"thermal"};
  std::vector<double> steps{100}, stiffness{1e6};
  granular::CollisionOptions common;
  std::string json, csv;
  int threads = 0;
};

/// The names given, or all known ones for "all".
std::vector<std::string> expand(const std::vector<std::string>& given, const std::vector<std::string>& all) {
  return given.size() == 1 && given[0] == "all" ? all : given;
}

std::vector<granular::CollisionPair> listPairs(const std::vector<std::string>& names) {
  std::vector<granular::CollisionPair> pairs;
  if (names.size() == 1 && names[0] == "all") {
    for (const granular::CollisionPair& pair : granular::collisionPairs()) pairs.push_back(pair);
  } else {
    for (const std::string& name : names) pairs.push_back(granular::findCollisionPair(name));
  }
  return pairs;
}

/// Every combination asked for; names are checked before the first run.
std::vector<granular::CollisionRow> listRows(const Options& options) {
  std::vector<std::string> ensembles;
  for (const granular::VelocityEnsemble& each : granular::velocityEnsembles()) ensembles.emplace_back(each.name);
  std::vector<std::string> rules;
  for (int k = 0; k <= static_cast<int>(granular::PointRule::foundation); ++k)
    rules.emplace_back(granular::pointRuleName(static_cast<granular::PointRule>(k)));
  std::vector<granular::CollisionRow> rows;
  for (const std::string& ensemble : expand(options.ensembles, ensembles)) {
    for (const std::string& law : expand(options.laws, {"linear", "linear_local", "tensor"})) {
      for (const std::string& rule : expand(options.rules, rules)) {
        for (const double stiffness : options.stiffness) {
          for (const double steps : options.steps) {
            for (const granular::CollisionPair& pair : listPairs(options.pairs)) {
              granular::CollisionRow row{pair, options.common, {}};
              row.options.ensemble = granular::findEnsemble(ensemble);
              row.options.law = granular::lawFromName(law);
              row.options.rule.rule = granular::pointRuleFromName(rule);
              row.options.stiffness = stiffness;
              row.options.stepsPerContact = steps;
              rows.push_back(row);
            }
          }
        }
      }
    }
  }
  return rows;
}

void write(const std::string& path, const std::string& text) {
  if (path.empty()) return;
  granular::OutputFile file(path);
  file.write(text);
  file.finish();
}

void run(const Options& options) {
  if (options.threads > 0) omp_set_num_threads(options.threads);
  std::vector<granular::CollisionRow> rows = listRows(options);
  for (granular::CollisionRow& row : rows) {
    row.result = granular::studyCollisions(granular::findColliderKind(row.pair.a),
                                           granular::findColliderKind(row.pair.b), row.options);
  }
  std::fputs(granular::formatCollisionTable(rows).c_str(), stdout);
  write(options.json, granular::formatCollisionJson(rows));
  write(options.csv, granular::formatCollisionCsv(rows));
}

std::string describeEnsembles() {
  std::string text = "velocities, or all:";
  for (const granular::VelocityEnsemble& each : granular::velocityEnsembles())
    text += "\n  " + std::string(each.name) + ": " + std::string(each.description);
  return text;
}

int parseAndRun(int argc, char** argv) {
  CLI::App app(
      "Lets pairs of particles collide in random poses without gravity, damping or friction limit, and measures what "
      "is "
      "left in the tangential spring when they part (Seelen et al. 2018, section 6.2, table 6), the change of total "
      "energy and angular momentum, and the loss of the same encounters in the limit of infinite stiffness.\n"
      "Options that take a list run every combination. Exit codes: 0 done, 1 bad input, 2 a problem of the program; "
      "others: wrong options.");
  Options options;
  app.add_option("--pair", options.pairs, "pairs such as cube-sphere, or all")->delimiter(',')->capture_default_str();
  app.add_option("--samples", options.common.samples, "collisions of each pair")->capture_default_str();
  app.add_option("--rule", options.rules,
                 "contact-point rules: witness, manifold, face_centroid, pressure_centroid, patch, stiff_patch, "
                 "foundation, or all")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--slab", options.common.rule.slab, "slab of face_centroid, as a fraction of the overlap")
      ->capture_default_str();
  app.add_option("--law", options.laws,
                 "linear (S: k_t from averaged masses), linear_local (from the contact's own), tensor, or all")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--ensemble", options.ensembles, describeEnsembles())->delimiter(',')->capture_default_str();
  app.add_option("--steps-per-contact", options.steps, "t_c/dt, t_c of S equation 14, at least 4")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--dt", options.common.dt, "time step, s, instead of --steps-per-contact");
  app.add_option("--kn", options.stiffness, "stiffness, N/m")->delimiter(',')->capture_default_str();
  app.add_option("--speed", options.common.speed, "deviation of the velocities, m/s")->capture_default_str();
  app.add_option("--seed", options.common.seed, "seed of the random numbers")->capture_default_str();
  app.add_option("--threads", options.threads, "threads; 0: all cores (the result does not depend on it)");
  app.add_option("--json", options.json, "file for the results; one study: its keys at the top level, else \"rows\"");
  app.add_option("--csv", options.csv, "file for the results as a table");
  CLI11_PARSE(app, argc, argv);
  run(options);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return exitCodeOf("collisions", [&] { return parseAndRun(argc, argv); });
}
