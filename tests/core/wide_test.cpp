// Quaternions side by side and alone against Eigen's, and rows of numbers as lanes.
#include <gtest/gtest.h>

#include "granular/core/random.h"
#include "granular/core/rows.h"

namespace granular {
namespace {

Vec3 toVec3(const Triple<Wide>& v, std::size_t k) { return {v.x[k], v.y[k], v.z[k]}; }
Quat toQuat(const Quadruple<Wide>& q, std::size_t k) { return {q.w[k], q.x[k], q.y[k], q.z[k]}; }

TEST(Quadruple, HasTheBitsOfEigensQuaternion) {
  Random random(3);
  for (int n = 0; n < 1000; ++n) {
    std::array<Quat, wideSize> p, q;
    std::array<Vec3, wideSize> v;
    for (std::size_t k = 0; k < wideSize; ++k) {
      p[k] = random.rotation();
      q[k] = random.rotation();
      v[k] = 1e3 * random.uniform() * random.direction();
    }
    Quadruple<Wide> ps, qs;
    Triple<Wide> vs;
    loadRows(p[0].coeffs().data(), 4, ps);
    loadRows(q[0].coeffs().data(), 4, qs);
    loadRows(v[0].data(), vs);
    const auto columns = ps.columns();
    for (std::size_t k = 0; k < wideSize; ++k) {
      const Quadruple<double> alone = toQuadruple(p[k]);
      EXPECT_EQ(toQuat(ps * qs, k).coeffs(), (p[k] * q[k]).coeffs());
      EXPECT_EQ(toQuat(alone * toQuadruple(q[k])).coeffs(), (p[k] * q[k]).coeffs());
      EXPECT_EQ(toVec3(ps.rotate(vs), k), p[k] * v[k]);
      EXPECT_EQ(toVec3(ps.conjugate().rotate(vs), k), p[k].conjugate() * v[k]);
      EXPECT_EQ(toVec3(alone.rotate(toTriple(v[k]))), p[k] * v[k]);
      EXPECT_EQ(ps.squaredNorm()[k], p[k].squaredNorm());
      EXPECT_EQ(vs.norm()[k], v[k].norm());
      const Mat3 R = p[k].toRotationMatrix();
      for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(toVec3(columns[c], k), R.col(static_cast<int>(c)));
    }
  }
}

TEST(Rows, BecomeLanesAndRowsAgain) {
  constexpr std::size_t stride = 5;
  std::array<double, stride * wideSize> rows, back{};
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<double>(k);
  Triple<Wide> v;
  loadRows(rows.data(), v);
  for (std::size_t k = 0; k < wideSize; ++k) EXPECT_EQ(toVec3(v, k), Vec3(3. * k, 3. * k + 1, 3. * k + 2));
  storeRows(v, back.data());
  for (std::size_t k = 0; k < rows.size(); ++k) EXPECT_EQ(back[k], k < 3 * wideSize ? rows[k] : 0);

  back.fill(-1);
  Quadruple<Wide> q;
  loadRows(rows.data(), stride, q);
  for (std::size_t k = 0; k < wideSize; ++k) {
    const double first = static_cast<double>(stride * k);
    EXPECT_EQ(toQuat(q, k).coeffs(), Eigen::Vector4d(first, first + 1, first + 2, first + 3));
  }
  storeRows(q, stride, back.data());
  for (std::size_t k = 0; k < rows.size(); ++k) EXPECT_EQ(back[k], k % stride < 4 ? rows[k] : -1);
}

template <std::size_t width>
void expectRowsBecomeLanesAndRowsAgain() {
  // Rows anywhere, in any order, of which no more than `width` numbers may be read or written.
  std::array<std::vector<double>, wideSize> rows, back;
  std::array<const double*, wideSize> from;
  std::array<double*, wideSize> to;
  for (std::size_t k = 0; k < wideSize; ++k) {
    for (std::size_t c = 0; c < width; ++c) rows[k].push_back(static_cast<double>(100 * k + c));
    back[k].assign(width + 8, -1);
    from[k] = rows[k].data();
    to[k] = back[k].data();
  }
  std::array<Wide, width> columns;
  loadRows(from, columns);
  for (std::size_t k = 0; k < wideSize; ++k)
    for (std::size_t c = 0; c < width; ++c) EXPECT_EQ(columns[c][k], rows[k][c]);
  storeRows(columns, to, wideSize - 1);
  for (std::size_t k = 0; k < wideSize; ++k)
    for (std::size_t c = 0; c < width + 8; ++c)
      EXPECT_EQ(back[k][c], k + 1 < wideSize && c < width ? rows[k][c] : -1) << "row " << k << ", number " << c;
}

TEST(Rows, AnywhereBecomeLanesAndRowsAgain) {
  expectRowsBecomeLanesAndRowsAgain<1>();
  expectRowsBecomeLanesAndRowsAgain<5>();
  expectRowsBecomeLanesAndRowsAgain<7>();
  expectRowsBecomeLanesAndRowsAgain<8>();
}

TEST(Wide, ComparisonsHoldForAllOrNot) {
  Wide x = 1 + Wide{};
  EXPECT_TRUE(all(x <= 1 + Wide{}));
  for (std::size_t k = 0; k < wideSize; ++k) {
    Wide y = x;
    y[k] = std::nan("");
    EXPECT_FALSE(all(y <= 1 + Wide{}));
    y[k] = 2;
    EXPECT_FALSE(all(y <= 1 + Wide{}));
    EXPECT_EQ(larger(x, y)[k], 2);
  }
}

}  // namespace
}  // namespace granular
