#include "granular/analysis/order.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace granular {

namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

Vec3 takeRadial(const Director& director) { return director.radial; }
Vec3 takeVertical(const Director&) { return Vec3::UnitZ(); }

/// Standard error of a mean from the sums of values and squares.
double estimateError(double sum, double squares, double n) {
  if (n < 2) return undefined;
  const double mean = sum / n;
  return std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1));
}

/// One row of an order profile.
std::vector<double> makeOrderRow(const std::vector<Director>& directors, double from, double to) {
  const auto within = [&](const Director& d) { return d.distance >= from && d.distance < to; };
  const Order radial = measureOrder(directors, takeRadial, within),
              vertical = measureOrder(directors, takeVertical, within);
  return {static_cast<double>(radial.count),
          radial.s2,
          radial.s2Error,
          radial.s4,
          radial.s4Error,
          vertical.s2,
          vertical.s4};
}

const std::vector<std::string> orderColumns = {"particles", "s2_r", "s2_r_error", "s4_r", "s4_r_error", "s2_z", "s4_z"};

constexpr const char* directorText =
    " Director: minor axis for aspect < 1, else major axis (S appendix B); irregular bodies: the principal axis whose "
    "moment "
    "differs most; spheres are left out. Distance: of the centre of mass from the side wall. Errors: standard, "
    "particles taken as "
    "independent.";

}  // namespace

std::vector<Director> collectDirectors(const Bed& bed, const CrossSection& section, double floor) {
  std::vector<Director> directors;
  directors.reserve(bed.size());
  for (std::size_t i = 0; i < bed.size(); ++i) {
    const Vec3& x = bed.frames[i].x;
    Director director;
    director.direction = Vec3::Zero();
    if (bed.shapes[i]->kind() != ShapeKind::sphere)
      director.direction = bed.frames[i].rotate(bed.shapes[i]->director());
    director.radial = Vec3::Zero();
    if (section.walled()) director.radial.head<2>() = section.outward(x.head<2>());
    director.tangential = Vec3::UnitZ().cross(director.radial);
    director.distance = section.distance(x.head<2>());
    director.height = x.z() - floor;
    directors.push_back(director);
  }
  return directors;
}

Order measureOrder(const std::vector<Director>& directors, const std::function<Vec3(const Director&)>& axis,
                   const std::function<bool(const Director&)>& keep) {
  double sum2 = 0, sum4 = 0, squares2 = 0, squares4 = 0;
  Order order;
  for (const Director& director : directors) {
    if (!keep(director)) continue;
    const Vec3 a = axis(director);
    if (a.isZero() || director.direction.isZero()) continue;
    const double c2 = std::pow(director.direction.dot(a), 2);
    const double p2 = 0.5 * (3 * c2 - 1), p4 = 0.125 * ((35 * c2 - 30) * c2 + 3);
    sum2 += p2;
    squares2 += p2 * p2;
    sum4 += p4;
    squares4 += p4 * p4;
    ++order.count;
  }
  const double n = static_cast<double>(order.count);
  order.s2 = n > 0 ? sum2 / n : undefined;
  order.s4 = n > 0 ? sum4 / n : undefined;
  order.s2Error = estimateError(sum2, squares2, n);
  order.s4Error = estimateError(sum4, squares4, n);
  return order;
}

double measureNematicOrder(const std::vector<Director>& directors) {
  Mat3 q = Mat3::Zero();
  double count = 0;
  for (const Director& d : directors) {
    if (d.direction.isZero()) continue;
    q += 1.5 * d.direction * d.direction.transpose();
    count += 1;
  }
  if (count == 0) return undefined;
  q = q / count - 0.5 * Mat3::Identity();
  return Eigen::SelfAdjointEigenSolver<Mat3>(q, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

Table tabulateRadialOrder(const std::vector<Director>& directors, const Regions& regions, double depth, double bin) {
  Table table{
      "order_radial",
      std::string("S2 and S4 of the directors against the radial direction (r) and the vertical (z), mean over the "
                  "particles of each annular bin, all heights.") +
          directorText,
      {"distance_m", "distance_unit_lengths"},
      {}};
  table.columns.insert(table.columns.end(), orderColumns.begin(), orderColumns.end());
  const int bins = std::max(1, static_cast<int>(std::ceil(depth / bin - 1e-9)));
  for (int k = 0; k < bins; ++k) {
    // The last bin reaches the middle, its centre included.
    const double from = k * bin, to = k + 1 < bins ? (k + 1) * bin : infinity;
    const double middle = 0.5 * (from + std::min(to, depth));
    std::vector<double> row = {middle, middle / regions.unit};
    const std::vector<double> order = makeOrderRow(directors, from, to);
    row.insert(row.end(), order.begin(), order.end());
    table.rows.push_back(row);
  }
  return table;
}

Table tabulateCumulativeOrder(const std::vector<Director>& directors, const Regions& regions, double depth,
                              double bin) {
  Table table{"order_cumulative",
              std::string("S2 and S4 as in order_radial, mean over all particles from the side wall to the distance.") +
                  directorText,
              {"distance_m", "distance_unit_lengths"},
              {}};
  table.columns.insert(table.columns.end(), orderColumns.begin(), orderColumns.end());
  const int bins = std::max(1, static_cast<int>(std::ceil(depth / bin - 1e-9)));
  for (int k = 0; k < bins; ++k) {
    const double to = std::min((k + 1) * bin, depth);
    std::vector<double> row = {to, to / regions.unit};
    const std::vector<double> order = makeOrderRow(directors, -infinity, k + 1 < bins ? to : infinity);
    row.insert(row.end(), order.begin(), order.end());
    table.rows.push_back(row);
  }
  return table;
}

Table tabulatePlaneOrder(const std::vector<Director>& directors, const Regions& regions, double stepDegrees) {
  Table table{
      "order_plane",
      std::string("S2 and S4 of the directors against a = cos(alpha) azimuthal + sin(alpha) vertical (S eq. B.2): "
                  "particles whose centre lies near the wall, in the core, and all.") +
          directorText,
      {"alpha_deg", "s2_near_wall", "s4_near_wall", "s2_core", "s4_core", "s2_all", "s4_all", "particles_near_wall",
       "particles_core", "particles_all"},
      {}};
  const auto nearWall = [&](const Director& d) {
    return d.distance < regions.nearWall && d.height >= regions.from && d.height <= regions.to;
  };
  const auto core = [&](const Director& d) {
    return regions.hasCore && d.distance >= regions.core && d.height >= regions.from && d.height <= regions.to;
  };
  const auto all = [](const Director&) { return true; };
  const int steps = std::max(1, static_cast<int>(std::lround(90 / stepDegrees)));
  for (int k = 0; k <= steps; ++k) {
    const double alpha = 90.0 * k / steps, angle = alpha * pi / 180;
    const auto axis = [&](const Director& d) -> Vec3 {
      if (d.radial.isZero()) return Vec3::Zero();
      return std::cos(angle) * d.tangential + std::sin(angle) * Vec3::UnitZ();
    };
    const Order a = measureOrder(directors, axis, nearWall), b = measureOrder(directors, axis, core),
                c = measureOrder(directors, axis, all);
    table.rows.push_back({alpha, a.s2, a.s4, b.s2, b.s4, c.s2, c.s4, static_cast<double>(a.count),
                          static_cast<double>(b.count), static_cast<double>(c.count)});
  }
  return table;
}

}  // namespace granular
