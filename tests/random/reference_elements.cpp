#include "random/reference_elements.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <array>
#include <limits>

namespace softkin::random_robots {

namespace {

template <class T>
using Square = std::array<std::array<T, 3>, 3>;

template <class T>
T determinant(const Square<T>& f) {
  return f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) - f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
         f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
}

/// C = F^T F
template <class T>
Square<T> cauchy_green(const Square<T>& f) {
  Square<T> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c[i][j] = f[0][i] * f[0][j] + f[1][i] * f[1][j] + f[2][i] * f[2][j];
  return c;
}

template <class T>
T square_sum(const Square<T>& a) {
  T sum(0);
  for (const auto& row : a)
    for (const T& x : row) sum += x * x;
  return sum;
}

/// W [MPa] of the laws that need no rotation.
template <class T>
T strain_energy(const ElasticLaw& law, const Square<T>& f) {
  const Square<T> c = cauchy_green(f);
  const T first = c[0][0] + c[1][1] + c[2][2];
  const auto constant = [](double x) { return T(static_cast<Real>(x)); };
  if (law.law == Law::st_venant_kirchhoff) {
    Square<T> strain = c;
    for (int i = 0; i < 3; ++i) strain[i][i] = strain[i][i] - T(1);
    for (auto& row : strain)
      for (T& x : row) x = T(0.5L) * x;
    const T trace = strain[0][0] + strain[1][1] + strain[2][2];
    return constant(law.mu) * square_sum(strain) + T(0.5L) * constant(law.lambda) * trace * trace;
  }
  const T j = determinant(f), swelling = j - T(1);
  if (law.law == Law::neo_hookean)
    return T(0.5L) * constant(law.mu) * (first - T(3)) - constant(law.mu) * swelling +
           T(0.5L) * (constant(law.lambda) + constant(law.mu)) * swelling * swelling;
  const T volumetric = T(0.5L) * constant(law.bulk) * swelling * swelling;
  const T barred = power(j, -2.0L / 3) * first - T(3);
  if (law.law == Law::gent)
    return T(-0.5L) * constant(law.mu) * constant(law.jm) * logarithm(T(1) - barred / constant(law.jm)) + volumetric;
  if (law.law == Law::yeoh)
    return barred * (constant(law.c10) + barred * (constant(law.c20) + barred * constant(law.c30))) + volumetric;
  const T second = T(0.5L) * (first * first - square_sum(c));
  return constant(law.c10) * barred + constant(law.c01) * (power(j, -4.0L / 3) * second - T(3)) + volumetric;
}

/// -J |F^-T e|^2 / 2 of a field e at rest, from the cofactors of F.
template <class T>
T field_energy(const Square<T>& f, const RealVec3& e) {
  T sum(0);
  for (int i = 0; i < 3; ++i) {
    T entry(0);
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      entry += (f[i1][j1] * f[i2][j2] - f[i1][j2] * f[i2][j1]) * T(e[j]);
    }
    sum += entry * entry;
  }
  return T(-0.5L) * sum / determinant(f);
}

/// J^(-2/3) F^T F; also of what is mirrored, as a law may have it where no branch pulls yet.
RealMat3 barred(const RealMat3& f) {
  const Real root = std::cbrt(f.determinant());
  return f.transpose() * f / (root * root);
}

/// Energy of a branch at the end of a step that began relaxed with bar C (docs/viscosity.md), but for a constant.
template <class T>
T branch_energy(const ViscousBranch& branch, double elapsed_s, const RealMat3& begun, const Square<T>& f) {
  const Real x = static_cast<Real>(elapsed_s) / branch.time_s, m = x > 0 ? -std::expm1(-x) / x : 1;
  const Square<T> c = cauchy_green(f);
  const T scale = power(determinant(f), -2.0L / 3);
  const T modulus = T(static_cast<Real>(branch.modulus_MPa));
  if (x < 1e-8L) {
    const RealMat3 inverse = begun.inverse();
    T sum(0);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sum += T(inverse(i, j)) * c[i][j];
    return T(0.5L) * modulus * scale * sum;
  }
  Square<T> mean;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) mean[i][j] = T(1 - m) * scale * c[i][j] + T(m * begun(i, j));
  return T(1.5L / (1 - m)) * modulus * power(determinant(mean), 1.0L / 3);
}

/// Derivative of an energy by F.
template <class Energy>
RealMat3 slope_of(const RealMat3& gradient, const Energy& energy) {
  RealMat3 p;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Square<Dual> f;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) f[r][c] = Dual(gradient(r, c), r == i && c == j ? 1 : 0);
      p(i, j) = energy(f).slope;
    }
  return p;
}

/// F = U diag(s) V^T with U V^T, the nearest rotation, proper.
struct SignedValues {
  RealMat3 left, right;
  RealVec3 values;

  explicit SignedValues(const RealMat3& f) {
    const Eigen::JacobiSVD<RealMat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Real sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    left = svd.matrixU() * RealVec3(1, 1, sign).asDiagonal();
    right = svd.matrixV();
    values = svd.singularValues().cwiseProduct(RealVec3(1, 1, sign));
  }
  [[nodiscard]] RealMat3 rotation() const { return left * right.transpose(); }
  /// Of the rotation, by F.
  [[nodiscard]] RealMat3 rate(const RealMat3& change) const {
    const RealMat3 seen = left.transpose() * change * right;
    RealMat3 turn;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) turn(i, j) = i == j ? 0 : (seen(i, j) - seen(j, i)) / (values[i] + values[j]);
    return left * turn * right.transpose();
  }
  /// Returns the stiffness against rotation about the softest of the three axes [-].
  [[nodiscard]] Real least() const { return values[1] + values[2]; }
};

/// 2 mu (F - R) + lambda tr(R^T F - I) R, R the rotation nearest to F.
RealMat3 corotational_stress(const ElasticLaw& law, const RealMat3& f) {
  const RealMat3 r = SignedValues(f).rotation();
  const Real swelling = (r.transpose() * f).trace() - 3;
  return 2 * static_cast<Real>(law.mu) * (f - r) + static_cast<Real>(law.lambda) * swelling * r;
}

}  // namespace

RealMat3 stress(const ElasticLaw& law, const RealMat3& gradient) {
  if (law.law == Law::corotational) return corotational_stress(law, gradient);
  if (forbids_inversion(law.law) && !(gradient.determinant() > 0))
    return RealMat3::Constant(std::numeric_limits<Real>::quiet_NaN());
  return slope_of(gradient, [&](const Square<Dual>& f) { return strain_energy(law, f); });
}

Real stiffness_bound(const ElasticLaw& law, const RealMat3& f) {
  const Real size = std::max<Real>(1, f.norm()), square = size * size;
  const Real swelling = std::abs(f.determinant() - 1);
  const Real mu = std::abs(law.mu), lambda = std::abs(law.lambda);
  const Real by_volume = square * square + 2 * swelling * size;  // of (J - 1)^2 / 2
  switch (law.law) {
    case Law::st_venant_kirchhoff:
      return (2 * mu + 3 * lambda) * 3 * square;
    case Law::corotational:
      return 4 * mu + lambda * (3 + 2 * size);
    case Law::neo_hookean:
      return mu * (1 + 2 * size) + (lambda + mu) * by_volume;
    case Law::gent: {
      const Real j = std::max<Real>(1e-12L, f.determinant());
      const Real sheared = square * std::pow(j, -2.0L / 3) * std::pow(1 + square / j, 2);
      const Real room = std::max<Real>(1e-9L, 1 - (std::pow(j, -2.0L / 3) * f.squaredNorm() - 3) / law.jm);
      return 2 * mu / room * sheared * (1 + sheared / (law.jm * room)) + law.bulk * by_volume;
    }
    default: {
      const Real j = std::max<Real>(1e-12L, f.determinant());
      const Real sheared = square * std::pow(j, -2.0L / 3) * std::pow(1 + square / j, 2);  // bar I1 and its slopes
      const Real c = std::abs(law.c10) + 4 * std::abs(law.c01) * sheared + 2 * std::abs(law.c20) * sheared +
                     3 * std::abs(law.c30) * sheared * sheared;
      return 4 * c * sheared + law.bulk * by_volume;
    }
  }
}

namespace {

/// Derivatives of the shape functions in the parent's coordinates at a quadrature point, its weight, and the functions.
struct ParentPoint {
  RealPoints slope;
  Real weight;
  std::vector<Real> shape{};
};

RealMat3 barycentric_slopes() {
  return RealMat3::Identity();  // of L_1, L_2, L_3; that of L_0 is minus their sum
}

RealVec3 barycentric_slope(int corner) {
  return corner == 0 ? RealVec3(-1, -1, -1) : RealVec3(barycentric_slopes().col(corner - 1));
}

std::vector<ParentPoint> linear_points() {
  ParentPoint point{RealPoints(4, 3), 1.0L / 6};
  for (int i = 0; i < 4; ++i) point.slope.row(i) = barycentric_slope(i).transpose();
  point.shape.assign(4, 0.25L);
  return {point};
}

std::vector<ParentPoint> quadratic_points() {
  std::vector<ParentPoint> points;
  const Real far = (5 - std::sqrt(5.0L)) / 20, near = 1 - 3 * far;
  for (int q = 0; q < 4; ++q) {
    const auto at = [&](int corner) { return corner == q ? near : far; };
    ParentPoint point{RealPoints(10, 3), 1.0L / 24};
    for (int i = 0; i < 4; ++i) point.slope.row(i) = (4 * at(i) - 1) * barycentric_slope(i).transpose();
    for (int e = 0; e < 6; ++e) {
      const auto& [i, j] = tetrahedron_edges[e];
      point.slope.row(4 + e) = 4 * (at(i) * barycentric_slope(j) + at(j) * barycentric_slope(i)).transpose();
    }
    for (int i = 0; i < 4; ++i) point.shape.push_back(at(i) * (2 * at(i) - 1));
    for (const auto& [i, j] : tetrahedron_edges) point.shape.push_back(4 * at(i) * at(j));
    points.push_back(point);
  }
  return points;
}

std::vector<ParentPoint> prism_points() {
  std::vector<ParentPoint> points;
  for (const int side : {-1, 1})
    for (int q = 0; q < 3; ++q) {
      const Real z = side / std::sqrt(3.0L);
      ParentPoint point{RealPoints(6, 3), 1.0L / 6, std::vector<Real>(6)};
      for (int i = 0; i < 3; ++i) {
        const Real l = i == q ? 2.0L / 3 : 1.0L / 6, x = i == 0 ? -1 : i == 1 ? 1 : 0, y = i == 0 ? -1 : i == 2 ? 1 : 0;
        point.slope.row(i) << x * (1 - z) / 2, y * (1 - z) / 2, -l / 2;
        point.slope.row(i + 3) << x * (1 + z) / 2, y * (1 + z) / 2, l / 2;
        point.shape[i] = l * (1 - z) / 2;
        point.shape[i + 3] = l * (1 + z) / 2;
      }
      points.push_back(point);
    }
  return points;
}

const std::vector<ParentPoint>& points_of(Eigen::Index nodes) {
  static const std::vector<ParentPoint> linear = linear_points(), quadratic = quadratic_points(),
                                        prism = prism_points();
  return nodes == 4 ? linear : nodes == 10 ? quadratic : prism;
}

/// Inverse of the active stretch: areas grow by the ratio in the plane of the triangles, the thickness shrinks by it.
RealMat3 inverse_stretch(const RealPoints& rest, Real ratio) {
  RealVec3 normal = RealVec3::Zero();
  for (int t = 0; t < 6; t += 3) {
    const RealVec3 u = rest.row(t + 1) - rest.row(t), v = rest.row(t + 2) - rest.row(t);
    normal += u.cross(v);
  }
  normal.normalize();
  const RealMat3 across = normal * normal.transpose();
  return (RealMat3::Identity() - across) / std::sqrt(ratio) + across * ratio;
}

}  // namespace

ElementPulls pulls_of(const ElasticLaw& law, const RealPoints& rest, const RealPoints& current, const LayerDrive& drive,
                      const BranchDrive& viscous, const ElementGrowth& growth) {
  constexpr Real ulp = std::numeric_limits<double>::epsilon();
  const Eigen::Index count = rest.rows();
  const std::size_t nodes = count;
  ElementPulls out{std::vector<RealVec3>(nodes, RealVec3::Zero()), std::vector<Real>(nodes, 0),
                   std::vector<Real>(nodes, 0)};
  const Real rest_size = rest.rowwise().norm().maxCoeff(), current_size = current.rowwise().norm().maxCoeff();
  for (const ParentPoint& point : points_of(count)) {
    const RealMat3 jacobian = (rest.rowwise() - rest.row(0)).transpose() * point.slope;
    const Real volume = point.weight * jacobian.determinant() * growth.volume();
    RealPoints slope = point.slope * jacobian.inverse() * growth.inverse();
    if (drive.ratio != 1) slope = slope * inverse_stretch(rest, drive.ratio);
    const RealMat3 gradient = (current.rowwise() - current.row(0)).transpose() * slope;
    RealMat3 p = stress(law, gradient);
    Real stiffness = stiffness_bound(law, gradient);
    const Real all = slope.rowwise().norm().sum();
    if (viscous.branches && std::isfinite(viscous.elapsed_s)) {
      RealPoints before = point.slope * jacobian.inverse() * viscous.begun_growth.inverse();
      if (viscous.begun_ratio != 1) before = before * inverse_stretch(rest, viscous.begun_ratio);
      const RealMat3 begun = barred((viscous.begun.rowwise() - viscous.begun.row(0)).transpose() * before);
      for (const ViscousBranch& branch : *viscous.branches) {
        if (!(gradient.determinant() > 0)) p.setConstant(std::numeric_limits<Real>::quiet_NaN());
        p += slope_of(gradient,
                      [&](const Square<Dual>& f) { return branch_energy(branch, viscous.elapsed_s, begun, f); });
        ElasticLaw spring;  // at once, when it is stiffest
        spring.law = Law::mooney_rivlin;
        spring.c10 = 0.5 * branch.modulus_MPa;
        stiffness += stiffness_bound(spring, gradient) * begun.inverse().norm();
      }
    }
    if (drive.pressure > 0) {  // the potential rises from the first triangle to the second, whatever the active stretch
      const RealMat3 relaxed = drive.ratio != 1 ? inverse_stretch(rest, drive.ratio) : RealMat3::Identity();
      const RealMat3 whole = gradient * relaxed.inverse(), inverse = whole.inverse();
      const RealVec3 across = (slope * relaxed.inverse()).bottomRows(3).colwise().sum().transpose();
      const RealMat3 field = slope_of(whole, [&](const Square<Dual>& f) { return field_energy(f, across); });
      p += drive.pressure * field * relaxed.inverse();
      const Real square = (inverse.transpose() * across).squaredNorm();
      stiffness += 10 * drive.pressure * std::abs(whole.determinant()) * square * inverse.squaredNorm();
    }
    const Real blurred = stiffness * all * (current_size + gradient.norm() * rest_size) * ulp +
                         p.norm() * (1 + all * rest_size) * ulp + stiffness * ulp;
    for (Eigen::Index a = 0; a < count; ++a) {
      const std::size_t i = a;
      const Real own = volume * slope.row(a).norm();
      out.force[i] += volume * (p * slope.row(a).transpose());
      out.stiffness[i] += own * stiffness * all;
      out.rounding[i] += own * blurred;
    }
  }
  return out;
}

ElementPulls family_pulls_of(const RealPoints& rest, const RealPoints& current, const std::vector<FibreDrive>& fibres) {
  constexpr Real ulp = std::numeric_limits<double>::epsilon();
  const Eigen::Index count = rest.rows();
  const std::size_t nodes = count;
  ElementPulls out{std::vector<RealVec3>(nodes, RealVec3::Zero()), std::vector<Real>(nodes, 0),
                   std::vector<Real>(nodes, 0)};
  const Real rest_size = rest.rowwise().norm().maxCoeff(), current_size = current.rowwise().norm().maxCoeff();
  for (const ParentPoint& point : points_of(count)) {
    const RealMat3 jacobian = (rest.rowwise() - rest.row(0)).transpose() * point.slope;
    const Real volume = point.weight * jacobian.determinant();
    const RealPoints slope = point.slope * jacobian.inverse();
    const RealMat3 gradient = (current.rowwise() - current.row(0)).transpose() * slope;
    const Real j = gradient.determinant(), all = slope.rowwise().norm().sum();
    for (const FibreDrive& fibre : fibres) {
      const RealVec3 along = gradient * fibre.direction;
      const Real scale = std::pow(std::abs(j), -2.0L / 3);
      const Real strain = fibre.dispersion * (scale * gradient.squaredNorm() - 3) +
                          (1 - 3 * fibre.dispersion) * (scale * along.squaredNorm() - 1);
      RealMat3 p = RealMat3::Zero();
      if (!(j > 0)) p.setConstant(std::numeric_limits<Real>::quiet_NaN());
      if (strain > 0)
        p += slope_of(gradient, [&](const Square<Dual>& f) {
          const Square<Dual> c = cauchy_green(f);
          Dual fourth(0);
          for (int r = 0; r < 3; ++r)
            for (int s = 0; s < 3; ++s) fourth += Dual(fibre.direction[r] * fibre.direction[s]) * c[r][s];
          const Dual bar = power(determinant(f), -2.0L / 3);
          const Dual e = Dual(fibre.dispersion) * (bar * (c[0][0] + c[1][1] + c[2][2]) - Dual(3)) +
                         Dual(1 - 3 * fibre.dispersion) * (bar * fourth - Dual(1));
          if (fibre.k2 == 0) return Dual(fibre.k1 / 2) * e * e;
          return Dual(fibre.k1 / (2 * fibre.k2)) * (exponential(Dual(fibre.k2) * e * e) - Dual(1));
        });
      const Real most = std::max<Real>(strain, 0), power_of = fibre.k2 * most * most;
      const Real sheared = scale * (1 + gradient.squaredNorm()) * (1 + gradient.squaredNorm() / std::abs(j));
      const Real stiffness =
          4 * fibre.k1 * std::exp(power_of) * sheared * ((1 + 2 * power_of) * sheared + most * (1 + sheared));
      const Real blurred = stiffness * all * (current_size + gradient.norm() * rest_size) * ulp +
                           p.norm() * (1 + all * rest_size) * ulp + stiffness * ulp;
      for (Eigen::Index a = 0; a < count; ++a) {
        const std::size_t i = a;
        const Real own = volume * slope.row(a).norm();
        out.force[i] += volume * (p * slope.row(a).transpose());
        out.stiffness[i] += own * stiffness * all;
        out.rounding[i] += own * blurred;
      }
    }
  }
  return out;
}

PressurePulls pressure_pulls_of(const RealPoints& rest, const RealPoints& current, const std::array<Real, 4>& pressures,
                                Real bulk, Real shear, const ElementGrowth& growth) {
  constexpr Real ulp = std::numeric_limits<double>::epsilon();
  const Eigen::Index count = rest.rows();
  const std::size_t nodes = count;
  PressurePulls out{
      {std::vector<RealVec3>(nodes, RealVec3::Zero()), std::vector<Real>(nodes, 0), std::vector<Real>(nodes, 0)}};
  const Real size = rest.rowwise().norm().maxCoeff() + current.rowwise().norm().maxCoeff();
  Real whole = 0;
  for (const ParentPoint& point : points_of(count)) {
    const RealMat3 jacobian = (rest.rowwise() - rest.row(0)).transpose() * point.slope;
    const Real volume = point.weight * jacobian.determinant() * growth.volume();
    const RealPoints slope = point.slope * jacobian.inverse() * growth.inverse();
    const RealMat3 f = (current.rowwise() - current.row(0)).transpose() * slope;
    RealMat3 cofactor;
    for (int i = 0; i < 3; ++i)
      cofactor.row(i) = RealVec3(f.row((i + 1) % 3)).cross(RealVec3(f.row((i + 2) % 3))).transpose();
    std::array<Real, 4> fraction;  // barycentric, of the shape functions of whatever order
    for (std::size_t i = 0; i < 4; ++i) {
      fraction[i] = point.shape[i];
      for (std::size_t e = 0; nodes == 10 && e < 6; ++e)
        if (tetrahedron_edges[e][0] == static_cast<int>(i) || tetrahedron_edges[e][1] == static_cast<int>(i))
          fraction[i] += point.shape[4 + e] / 2;
    }
    Real p = 0;
    for (std::size_t i = 0; i < 4; ++i) p += fraction[i] * pressures[i];
    const Real j = f.determinant(), all = slope.rowwise().norm().sum();
    whole += volume;
    for (std::size_t i = 0; i < 4; ++i) {
      out.missed[i] += volume * fraction[i] * (j - 1 - p / bulk);
      out.volume[i] +=
          volume * fraction[i] * (1 + std::abs(j) + std::abs(p / bulk) + f.norm() * f.norm() * all * size * ulp);
      out.area[i] += volume * fraction[i] * cofactor.norm() * all;
    }
    for (Eigen::Index a = 0; a < count; ++a) {
      const Real own = volume * slope.row(a).norm() * std::abs(p);
      out.pulls.force[a] += volume * p * (cofactor * slope.row(a).transpose());
      out.pulls.stiffness[a] += own * 2 * f.norm() * all;
      out.pulls.rounding[a] += own * f.norm() * (f.norm() + 2 * all * size) * ulp;
    }
  }
  Real mean = 0;
  for (const Real pressure : pressures) mean += pressure / 4;
  for (std::size_t i = 0; nodes == 4 && i < 4; ++i) {  // integral of L_i (p - mean)
    Real left = -whole * mean / 4;
    for (std::size_t j = 0; j < 4; ++j) left += whole * (i == j ? 0.1L : 0.05L) * pressures[j];
    out.missed[i] -= left * (1 / bulk + 1 / shear);
    out.volume[i] += whole * (std::abs(mean) + std::abs(pressures[i])) * (1 / bulk + 1 / shear);
  }
  return out;
}

ElementPulls magnetic_pulls_of(const RealPoints& rest, const RealPoints& current, const RealVec3& remanence, bool turns,
                               const std::function<RealFlux(const RealVec3&)>& flux) {
  constexpr Real permeability = 4e-7L * 3.14159265358979323846L;  // [T m / A]; 1 mT^2 is 1e-6 T^2, 1 MPa 1e6 Pa
  constexpr Real ulp = std::numeric_limits<double>::epsilon();
  const Eigen::Index count = rest.rows();
  const std::size_t nodes = count;
  ElementPulls out{std::vector<RealVec3>(nodes, RealVec3::Zero()), std::vector<Real>(nodes, 0),
                   std::vector<Real>(nodes, 0)};
  const Real rest_size = rest.rowwise().norm().maxCoeff(), current_size = current.rowwise().norm().maxCoeff();
  for (const ParentPoint& point : points_of(count)) {
    const RealMat3 jacobian = (rest.rowwise() - rest.row(0)).transpose() * point.slope;
    const Real scale = point.weight * jacobian.determinant() * 1e-12L / permeability;
    const RealPoints slope = point.slope * jacobian.inverse();
    const RealMat3 gradient = (current.rowwise() - current.row(0)).transpose() * slope;
    const SignedValues values(gradient);
    RealVec3 at = RealVec3::Zero();
    for (Eigen::Index a = 0; a < count; ++a) at += point.shape[a] * current.row(a).transpose();
    const RealFlux field = flux(at);
    const RealVec3 pull = field.slope.transpose() * ((turns ? values.rotation() : gradient) * remanence);
    RealMat3 by_gradient = field.value * remanence.transpose();
    if (turns)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          RealMat3 change = RealMat3::Zero();
          change(i, j) = 1;
          by_gradient(i, j) = field.value.dot(values.rate(change) * remanence);
        }
    // how it turns changes by the same, over how hard it is to turn
    const Real all = slope.rowwise().norm().sum();
    const Real stiffness = turns ? 2 * remanence.norm() * field.value.norm() / (values.least() * values.least()) : 0;
    const Real blurred = stiffness * ulp * (1 + all * (current_size + gradient.norm() * rest_size));
    for (Eigen::Index a = 0; a < count; ++a) {
      const std::size_t i = a;
      const Real own = scale * slope.row(a).norm();
      out.force[i] -= scale * (by_gradient * slope.row(a).transpose() + point.shape[i] * pull);
      out.stiffness[i] += own * stiffness * all;
      out.rounding[i] += own * blurred;
    }
  }
  return out;
}

}  // namespace softkin::random_robots
