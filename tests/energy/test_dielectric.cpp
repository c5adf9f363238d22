#include <gtest/gtest.h>

#include <softkin/energy/dielectric.hpp>

#include "elastic_samples.hpp"

namespace softkin::energy {

namespace {

constexpr double voltage_kV = 2.7;

/// Eight deformed prisms, each with a permittivity of its own.
struct Layers {
  Sample<6, 6> sample;
  Pack permittivity{};

  explicit Layers(Random& random) : sample(random_sample<6, 6>(Law::neo_hookean, random)) {
    for (int l = 0; l < lanes; ++l) permittivity[l] = random.between(0.1, 0.4);
  }
  [[nodiscard]] ElasticForce<6> force(const std::vector<Nodes<6>>& current, double voltage = voltage_kV) const {
    Shape<6> shape;
    pack_nodes<6>(current, shape);
    ElasticForce<6> out{};
    add_dielectric_force(sample.block, permittivity, voltage, shape, out);
    return out;
  }
  [[nodiscard]] std::vector<Eigen::MatrixXd> stiffness() const {
    Shape<6> shape;
    pack_nodes<6>(sample.current, shape);
    ElasticStiffness<6> out{};
    add_dielectric_stiffness(sample.block, permittivity, voltage_kV, shape, out);
    std::vector<Eigen::MatrixXd> k(lanes, Eigen::MatrixXd::Zero(18, 18));
    for (int l = 0; l < lanes; ++l)
      for (int a = 0, ab = 0; a < 6; ++a)
        for (int b = 0; b <= a; ++b, ++ab)
          for (int i = 0; i < 3; ++i) {
            k[l].block<1, 3>(3 * a + i, 3 * b) = get_lane(out.block[ab].row[i], l).transpose();
            k[l].block<3, 1>(3 * b, 3 * a + i) = get_lane(out.block[ab].row[i], l);
          }
    return k;
  }
};

}  // namespace

TEST(Dielectric, DerivativesAreThoseOfTheEnergy) {
  constexpr double step = 1e-5;
  Random random(1);
  for (int round = 0; round < 5; ++round) {
    const Layers layers(random);
    const ElasticForce<6> force = layers.force(layers.sample.current);
    const auto stiffness = layers.stiffness();
    for (int a = 0; a < 6; ++a)
      for (int i = 0; i < 3; ++i) {
        std::vector<Nodes<6>> ahead = layers.sample.current, behind = ahead;
        for (int l = 0; l < lanes; ++l) ahead[l](a, i) += step, behind[l](a, i) -= step;
        const ElasticForce<6> up = layers.force(ahead), down = layers.force(behind);
        for (int l = 0; l < lanes; ++l) {
          const Nodes<6> g = gradient_of(force, l);
          EXPECT_GT(g.norm(), 1e-2);
          EXPECT_NEAR(g(a, i), (up.energy[l] - down.energy[l]) / (2 * step), 1e-7 * g.norm());
          const Nodes<6> change = (gradient_of(up, l) - gradient_of(down, l)) / (2 * step);
          const Eigen::VectorXd column = change.transpose().reshaped();
          EXPECT_LT((stiffness[l].col(3 * a + i) - column).norm(), 1e-7 * stiffness[l].norm());
        }
      }
  }
}

/// A flat capacitor of area A and thickness H that is stretched: C = eps A / H l1 l2 / l3, whatever its turn.
TEST(Dielectric, EnergyIsThatOfAFlatCapacitor) {
  const double area = 3, thickness = 0.5;  // [mm^2], [mm]
  Nodes<6> rest;
  rest << 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, thickness, 3, 0, thickness, 0, 2, thickness;
  Random random(2);
  Layers layers(random);
  const Vec3 s(1.4, 0.8, 0.6);
  for (int l = 0; l < lanes; ++l)
    layers.sample.set(l, rest, rest * (random.rotation() * Mat3(s.asDiagonal())).transpose());
  for (const double voltage : {voltage_kV, -voltage_kV}) {
    const ElasticForce<6> force = layers.force(layers.sample.current, voltage);
    for (int l = 0; l < lanes; ++l) {
      const double capacitance = layers.permittivity[l] * area / thickness * s[0] * s[1] / s[2];
      EXPECT_NEAR(force.energy[l], -0.5 * capacitance * voltage * voltage, 1e-12);
    }
  }
}

TEST(Dielectric, RigidMotionKeepsTheEnergyAndTurnsTheForce) {
  Random random(3);
  const Layers layers(random);
  const Mat3 r = random.rotation();
  auto moved = layers.sample.current;
  for (Nodes<6>& nodes : moved) nodes = (nodes * r.transpose()).rowwise() + Eigen::RowVector3d(30, -20, 50);
  const ElasticForce<6> before = layers.force(layers.sample.current), after = layers.force(moved);
  for (int l = 0; l < lanes; ++l) {
    EXPECT_NEAR(after.energy[l], before.energy[l], 1e-11 * std::abs(before.energy[l]));
    const Nodes<6> expected = gradient_of(before, l) * r.transpose();
    EXPECT_LT((gradient_of(after, l) - expected).norm(), 1e-11 * expected.norm());
    EXPECT_LT(gradient_of(before, l).colwise().sum().norm(), 1e-13 * expected.norm());
  }
}

/// Electrodes attract each other with eps e^2 / 2 across the layer, and push along it with as much.
TEST(Dielectric, MaxwellsStressIsThatOfTheTrueField) {
  const double thickness = 0.5;
  Nodes<6> rest;
  rest << 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, thickness, 3, 0, thickness, 0, 2, thickness;
  Random random(4);
  Layers layers(random);
  const Vec3 s(1.4, 0.8, 0.6);
  for (int l = 0; l < lanes; ++l) layers.sample.set(l, rest, rest * s.asDiagonal());
  Shape<6> shape;
  pack_nodes<6>(layers.sample.current, shape);
  Pack33 stress[6] = {};
  add_maxwell_stress(layers.sample.block, layers.permittivity, voltage_kV, shape, stress);
  const double field = voltage_kV / (s[2] * thickness);
  for (const Pack33& point : stress)
    for (int l = 0; l < lanes; ++l) {
      const double half = 0.5 * layers.permittivity[l] * field * field;
      EXPECT_NEAR(point.row[0].x[l], -half, 1e-12 * half);
      EXPECT_NEAR(point.row[1].y[l], -half, 1e-12 * half);
      EXPECT_NEAR(point.row[2].z[l], half, 1e-12 * half);
      EXPECT_NEAR(point.row[0].z[l], 0, 1e-12 * half);
    }
}

/// Flat and inverted layers have no energy; layers without a voltage or a permittivity are not evaluated.
TEST(Dielectric, InvertedLayersAreForbiddenAndFinite) {
  Random random(5);
  Layers layers(random);
  layers.permittivity[4] = 0;
  for (const double height : {0.0, -0.5}) {
    for (const int l : {2, 4}) layers.sample.current[l] = layers.sample.rest[l] * Vec3(1, 1, height).asDiagonal();
    const ElasticForce<6> force = layers.force(layers.sample.current);
    EXPECT_TRUE(force.forbidden[2]);
    EXPECT_FALSE(force.forbidden[3]);
    EXPECT_FALSE(force.forbidden[4]);
    EXPECT_FALSE(layers.force(layers.sample.current, 0).forbidden[2]);
    EXPECT_TRUE(std::isfinite(force.energy[2]));
    EXPECT_TRUE(gradient_of(force, 2).allFinite());
    EXPECT_TRUE(layers.stiffness()[2].allFinite());
  }
}

}  // namespace softkin::energy
