#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/energy/sheet.hpp>

namespace softkin::energy {

namespace {

constexpr double pressed_fraction = 1e-6;

SheetResponse unrelaxed(const SheetLaw& law, const Vec3& strain) {
  if (law.rubber) return taut_rubber(*law.rubber, strain);
  const Vec3 stress = law.stiffness * strain;
  return {strain.dot(stress) / 2, stress, law.stiffness, SheetState::taut};
}

/// A stress along one direction: t t^T as (11, 22, 12), its derivatives by the angle, and W = a^2 / (2 m) with them.
struct Uniaxial {
  Vec3 along, turned, twice;
  double a, a1, a2, m, m1, m2;

  Uniaxial(const SheetLaw& law, const Vec3& strain, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    along = Vec3(c * c, s * s, c * s);
    turned = Vec3(-2 * c * s, 2 * c * s, c * c - s * s);
    twice = Vec3(-2 * (c * c - s * s), 2 * (c * c - s * s), -4 * c * s);
    a = along.dot(strain);
    a1 = turned.dot(strain);
    a2 = twice.dot(strain);
    const Vec3 soft = law.compliance * along;
    m = along.dot(soft);
    m1 = 2 * turned.dot(soft);
    m2 = 2 * twice.dot(soft) + 2 * turned.dot(law.compliance * turned);
  }
  [[nodiscard]] double energy() const { return a * a / (2 * m); }
  /// Its signed root, which is largest where the energy of a pull is.
  [[nodiscard]] double root() const { return a / std::sqrt(m); }
  /// What has the sign of the root's slope, and its own slope.
  [[nodiscard]] double rise() const { return 2 * a1 * m - a * m1; }
  [[nodiscard]] double rise_slope() const { return 2 * a2 * m + a1 * m1 - a * m2; }
  [[nodiscard]] double curvature() const {
    return (a1 * a1 + a * a2) / m - 2 * a * a1 * m1 / (m * m) - a * a * m2 / (2 * m * m) +
           a * a * m1 * m1 / (m * m * m);
  }
};

/// The direction that pulls most: the best of several, then Newton's method within its neighbours.
double taut_direction(const SheetLaw& law, const Vec3& strain) {
  constexpr int tried = 24, max_steps = 30;
  const double apart = std::numbers::pi / tried;
  double best = 0, most = Uniaxial(law, strain, 0).root();
  for (int i = 1; i < tried; ++i)
    if (const double root = Uniaxial(law, strain, i * apart).root(); root > most) {
      most = root;
      best = i * apart;
    }
  double low = best - apart, high = best + apart;
  for (int i = 0; i < max_steps; ++i) {
    const Uniaxial at(law, strain, best);
    const double rise = at.rise(), slope = at.rise_slope();
    (rise > 0 ? low : high) = best;
    double next = slope < 0 ? best - rise / slope : (low + high) / 2;
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    if (next == best) break;
    best = next;
  }
  return best;
}

SheetResponse wrinkled(const SheetLaw& law, const Vec3& strain) {
  if (law.rubber) return wrinkled_rubber(*law.rubber, strain);
  const Uniaxial at(law, strain, taut_direction(law, strain));
  SheetResponse out{at.energy(), at.a / at.m * at.along, at.along * at.along.transpose() / at.m, SheetState::wrinkled};
  const Vec3 turning = (at.a1 / at.m - at.a * at.m1 / (at.m * at.m)) * at.along + at.a / at.m * at.turned;
  if (const double curvature = at.curvature(); curvature < 0) out.tangent -= turning * turning.transpose() / curvature;
  return out;
}

/// Of (11, 22, 12), of a strain half of its last.
double min_principal(double x, double y, double xy) {
  return (x + y) / 2 - std::hypot((x - y) / 2, xy);
}
double greatest_principal(double x, double y, double xy) {
  return (x + y) / 2 + std::hypot((x - y) / 2, xy);
}

}  // namespace

SheetResponse sheet_response(const SheetLaw& law, const Vec3& strain) {
  const SheetResponse all = unrelaxed(law, strain);
  if (!law.tension_only || min_principal(all.stress[0], all.stress[1], all.stress[2]) >= 0) return all;
  SheetResponse out;
  if (greatest_principal(strain[0], strain[1], strain[2] / 2) <= 0)
    out.state = SheetState::slack;
  else
    out = wrinkled(law, strain);
  out.energy += pressed_fraction * (all.energy - out.energy);
  out.stress += pressed_fraction * (all.stress - out.stress);
  out.tangent += pressed_fraction * (all.tangent - out.tangent);
  return out;
}

SheetResponse smooth_sheet_response(const SheetLaw& law, const Vec3& strain, double barrier) {
  constexpr int max_steps = 100;
  constexpr double inside = 0.9, near = 1e-13;  // of the step to a singular stress; of the decrement
  if (!law.tension_only) return unrelaxed(law, strain);
  if (law.rubber) return smooth_sheet_response({law.stiffness, law.compliance, true}, strain, barrier);
  const double scale = law.stiffness(0, 0), mu = barrier * scale;
  const auto det = [](const Vec3& s) { return s[0] * s[1] - s[2] * s[2]; };
  Vec3 stress = sheet_response(law, strain).stress + Vec3(1, 1, 0) * (std::sqrt(barrier) * scale);
  if (!(det(stress) > 0)) stress = Vec3(1, 1, 0) * stress.norm();  // pressed by what slack sheets keep
  Mat3 tangent;
  for (int i = 0; i < max_steps; ++i) {
    const Vec3 inverse = Vec3(stress[1], stress[0], -2 * stress[2]) / det(stress);  // by S, of log det S
    Mat3 second;                                                                    // less that of log det S
    second << inverse[0] * inverse[0], stress[2] * stress[2] / (det(stress) * det(stress)), inverse[0] * inverse[2], 0,
        inverse[1] * inverse[1], inverse[1] * inverse[2], 0, 0, 2 / det(stress) + inverse[2] * inverse[2];
    second.triangularView<Eigen::StrictlyLower>() = second.transpose();
    const Vec3 rise = strain - law.compliance * stress + mu * inverse;
    tangent = (law.compliance + mu * second).inverse();
    const Vec3 step = tangent * rise;
    double length = 1;
    while (!(det(stress + length / inside * step) > 0 && stress[0] + length / inside * step[0] > 0)) length /= 2;
    stress += length * step;
    if (length == 1 && step.dot(rise) < near * mu) break;
  }
  return {strain.dot(stress) - stress.dot(law.compliance * stress) / 2 + mu * std::log(det(stress) / (scale * scale)),
          stress, tangent, SheetState::taut};
}

}  // namespace softkin::energy
