#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <softkin/model/layer.hpp>

#include "random/confirm_loads.hpp"

namespace softkin::random_robots {

namespace {

using SheetGradient = Eigen::Matrix<Real, 3, 2>;
using Plane = Eigen::Matrix<Real, 2, 2>;

/// A stress that pulls along one direction t only, as the wrinkles across it leave no shear: of the angles at which s M
/// t t has the strain's shear to t, that at which the strain pulls and the wrinkles are deep.
RealVec3 wrinkled_stress(const SheetLaw& law, const RealVec3& strain) {
  const auto along = [](Real angle) {
    const Real c = std::cos(angle), s = std::sin(angle);
    return RealVec3(c * c, s * s, c * s);
  };
  const auto shear = [](Real angle) {  // t . E n of (11, 22, 2 12)
    const Real c = std::cos(angle), s = std::sin(angle);
    return RealVec3(-c * s, c * s, (c * c - s * s) / 2);
  };
  const Eigen::Matrix<Real, 3, 3> compliance = law.compliance.cast<Real>();
  const auto missed = [&](Real angle) {
    const RealVec3 soft = compliance * along(angle);
    return shear(angle).dot(strain) * along(angle).dot(soft) - along(angle).dot(strain) * shear(angle).dot(soft);
  };
  constexpr int parts = 720;
  const Real part = std::acos(Real(-1)) / parts;
  RealVec3 best = RealVec3::Zero();
  Real most = -1;
  for (int i = 0; i < parts; ++i) {
    Real low = i * part, high = low + part;
    const Real from = missed(low);
    if (from * missed(high) > 0) continue;
    for (int k = 0; k < 80; ++k) {
      const Real middle = (low + high) / 2;
      (from * missed(middle) > 0 ? low : high) = middle;
    }
    const RealVec3 t = along(low);
    const Real pull = t.dot(strain) / t.dot(compliance * t);
    if (const Real energy = pull > 0 ? pull * t.dot(strain) : 0; energy > most) {
      most = energy;
      best = pull > 0 ? RealVec3(pull * t) : RealVec3(RealVec3::Zero());
    }
  }
  return best;
}

/// Of rubber, by its principal stretches: S of each is its force over the stretch.
RealVec3 rubber_stress(const SheetLaw& law, const RealVec3& strain) {
  const SheetRubber& rubber = *law.rubber;
  Plane c;
  c << 2 * strain[0] + 1, strain[2], strain[2], 2 * strain[1] + 1;
  const Eigen::SelfAdjointEigenSolver<Plane> principal(c);
  const Real a = std::sqrt(principal.eigenvalues()[1]), b = std::sqrt(principal.eigenvalues()[0]);
  const auto slope_of = [&](Real first) {  // of the energy, by I1
    const Real over = first - 3;
    return static_cast<Real>(rubber.c10) + 2 * static_cast<Real>(rubber.c20) * over +
           3 * static_cast<Real>(rubber.c30) * over * over;
  };
  const auto c01 = static_cast<Real>(rubber.c01);
  const auto force = [&](Real along, Real across) {  // by the stretch along, the third keeps the volume
    const Real third = 1 / (along * across), by_first = slope_of(along * along + across * across + third * third);
    return 2 * by_first * (along - third * third / along) +
           2 * c01 * (along * across * across - 1 / (along * along * along));
  };
  const auto stress_of = [&](Real most, Real least) {
    const Plane s = most / a * principal.eigenvectors().col(1) * principal.eigenvectors().col(1).transpose() +
                    least / b * principal.eigenvectors().col(0) * principal.eigenvectors().col(0).transpose();
    return RealVec3(s(0, 0), s(1, 1), s(0, 1));
  };
  const RealVec3 plain = stress_of(force(a, b), force(b, a));
  if (!law.tension_only || b * b * a >= 1) return plain;
  const Real pull = a > 1 ? force(a, 1 / std::sqrt(a)) : 0;
  const RealVec3 relaxed = stress_of(pull, 0);
  return relaxed + Real(1e-6) * (plain - relaxed);
}

RealVec3 sheet_stress(const SheetLaw& law, const RealVec3& strain) {
  if (law.rubber) return rubber_stress(law, strain);
  const RealVec3 plain = law.stiffness.cast<Real>() * strain;
  const auto presses = [](Real x, Real y, Real xy) { return x + y < 0 || x * y < xy * xy; };
  if (!law.tension_only || !presses(plain[0], plain[1], plain[2])) return plain;
  const bool pulls = strain[0] + strain[1] > 0 || strain[0] * strain[1] < strain[2] * strain[2] / 4;
  const RealVec3 relaxed = pulls ? wrinkled_stress(law, strain) : RealVec3(RealVec3::Zero());
  return relaxed + Real(1e-6) * (plain - relaxed);
}

void add_membrane(const Layer& layer, const State& state, Forces& forces) {
  for (const LayerPlace& place : layer.places) {
    SheetGradient f = SheetGradient::Zero();
    Real fractions = 0;
    for (std::size_t i = 0; i < place.vertices.size(); ++i) {
      const RealVec3 x = state.positions.row(place.vertices[i]).transpose().cast<Real>();
      f += x * place.slopes[i].transpose().cast<Real>();
      fractions += x.norm() * static_cast<Real>(place.slopes[i].norm());
    }
    const Plane c = f.transpose() * f;
    const RealVec3 s = sheet_stress(layer.law, {(c(0, 0) - 1) / 2, (c(1, 1) - 1) / 2, c(0, 1)});
    Plane stress;
    stress << s[0], s[2], s[2], s[1];
    const Real volume = static_cast<Real>(place.area_mm2) * static_cast<Real>(layer.thickness_mm);
    const Real modulus = static_cast<Real>(layer.law.stiffness.diagonal().maxCoeff());
    for (std::size_t i = 0; i < place.vertices.size(); ++i) {
      const Eigen::Matrix<Real, 2, 1> slope = place.slopes[i].cast<Real>();
      forces.add(place.vertices[i], volume * (f * (stress * slope)),
                 rounding_unit * volume * modulus * slope.norm() * (sums * fractions + 1));
      forces.stiffness[place.vertices[i]] += volume * modulus * slope.squaredNorm();
    }
  }
}

using Corners = std::vector<RealVec3>;

RealVec3 summed(const Corners& corners, const std::vector<Real>& fractions) {
  RealVec3 sum = RealVec3::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) sum += fractions[i] * corners[i];
  return sum;
}

template <class Parts>
std::vector<Real> column_of(const std::vector<Parts>& parts, int column) {
  std::vector<Real> fractions;
  for (const Parts& part : parts) fractions.push_back(static_cast<Real>(part[column]));
  return fractions;
}

Real energy_of(const LayerBend& bend, const Corners& x) {
  const auto at = [&](int column) { return summed(x, column_of(bend.parts, column)); };
  const RealVec3 normal = at(0).cross(at(1)).normalized();
  const RealVec3 bent =
      RealVec3(at(2).dot(normal), at(3).dot(normal), 2 * at(4).dot(normal)) - bend.place.rest.cast<Real>();
  return bent.dot(bend.place.stiffness.cast<Real>() * bent) / 2;
}

Real energy_of(const LayerJoint& layer, const Corners& x) {
  const BendingJoint& joint = layer.joint;
  std::array<RealVec3, 2> above;
  Real moment = 0;
  RealVec3 edge = RealVec3::Zero();
  for (std::size_t s = 0; s < 2; ++s) {
    const std::size_t first = s == 0 ? 0 : layer.sides[0].vertices.size();
    const Corners own(x.begin() + static_cast<std::ptrdiff_t>(first),
                      x.begin() + static_cast<std::ptrdiff_t>(first + layer.sides[s].vertices.size()));
    const auto at = [&](int column) { return summed(own, column_of(layer.sides[s].parts, column)); };
    above[s] = static_cast<Real>(joint.upwards[s]) * at(0).cross(at(1)).normalized();
    moment += static_cast<Real>(joint.fraction[s]) * (above[s].dot(at(2)) - static_cast<Real>(joint.moment[s]));
    if (s == 0) edge = static_cast<Real>(joint.along[0]) * at(0) + static_cast<Real>(joint.along[1]) * at(1);
  }
  const Real jump = std::atan2(above[1].cross(above[0]).dot(edge.normalized()), above[0].dot(above[1])) -
                    static_cast<Real>(joint.angle);
  return static_cast<Real>(joint.length) * (moment * jump + static_cast<Real>(joint.penalty) * jump * jump / 2);
}

/// Adds differences of the energy of a place of these vertices; of such that it has twice, of each.
template <class Place>
void add_differences(const Place& place, const std::vector<Index>& vertices, Real stiffest, const State& state,
                     Forces& forces) {
  Corners corners;
  for (const Index v : vertices) corners.push_back(state.positions.row(v).transpose().cast<Real>());
  const Real little = Real(1e-5) * (corners[0] - corners[1]).norm();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    RealVec3 force;
    for (int axis = 0; axis < 3; ++axis) {
      Corners high = corners, low = corners;
      high[i][axis] += little;
      low[i][axis] -= little;
      force[axis] = (energy_of(place, high) - energy_of(place, low)) / (2 * little);
    }
    const Real blur = corners[i].norm() * sums;  // of a place, by rounding
    forces.add(vertices[i], force, Real(1e-8) * force.norm() + rounding_unit * stiffest * blur);
    forces.stiffness[vertices[i]] += stiffest;
  }
}

void add_moments(const Layer& layer, const State& state, Forces& forces) {
  const auto square = [](const auto& parts) {
    Real largest = 0;
    for (const auto& part : parts) largest = std::max(largest, static_cast<Real>(part.squaredNorm()));
    return largest;
  };
  for (const LayerBend& bend : layer.bends)
    add_differences(bend, bend.vertices, static_cast<Real>(bend.place.stiffness.norm()) * square(bend.parts), state,
                    forces);
  for (const LayerJoint& joint : layer.joints) {
    std::vector<Index> vertices = joint.sides[0].vertices;
    vertices.insert(vertices.end(), joint.sides[1].vertices.begin(), joint.sides[1].vertices.end());
    Real slopes = 0;
    for (const LayerJoint::Side& side : joint.sides)
      for (const Vec3& part : side.parts) slopes = std::max(slopes, static_cast<Real>(part.head<2>().squaredNorm()));
    add_differences(joint, vertices,
                    static_cast<Real>(joint.joint.length) * 2 * static_cast<Real>(joint.joint.penalty) * slopes, state,
                    forces);
  }
}

}  // namespace

void add_layers(const Model& model, const State& state, Forces& forces) {
  for (const auto& layer : model.reinforcement.layers) {
    add_membrane(*layer, state, forces);
    add_moments(*layer, state, forces);
  }
}

}  // namespace softkin::random_robots
