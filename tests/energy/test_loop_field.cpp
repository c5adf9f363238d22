#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <softkin/energy/loop_field.hpp>

namespace softkin::energy {

namespace {

const Eigen::Vector3d middle(3, -2, 5), turned_about = Eigen::Vector3d(1, 2, -0.5).normalized();
constexpr double ring = 7, strength = 0.3;

LoopOfCurrent sample_loop() {
  LoopOfCurrent loop{};
  for (int i = 0; i < 3; ++i) {
    loop.center[i] = middle[i];
    loop.axis[i] = turned_about[i];
  }
  loop.radius_mm = ring;
  loop.scale = strength;
  return loop;
}

/// On the axis, near it, near the wire (0.05 of the radius), far away (20 radii), and on both sides of where series
/// end.
std::array<Eigen::Vector3d, lanes> sample_places() {
  const Eigen::Vector3d across = turned_about.unitOrthogonal(), other = turned_about.cross(across);
  return {middle,
          middle + 4 * turned_about,
          middle + 1e-4 * across - 3 * turned_about,
          middle + 0.2 * ring * across + 0.3 * ring * other,
          middle + 1.05 * ring * other,
          middle + 0.95 * ring * across + 0.02 * ring * turned_about,
          middle + 1.7 * ring * across - 1.1 * ring * turned_about,
          middle - 20 * ring * other + 3 * turned_about};
}

Pack3 packed(const std::array<Eigen::Vector3d, lanes>& places) {
  Pack3 pack;
  for (int l = 0; l < lanes; ++l) {
    pack.x[l] = places[l][0];
    pack.y[l] = places[l][1];
    pack.z[l] = places[l][2];
  }
  return pack;
}

FluxPoint field_at(const std::array<Eigen::Vector3d, lanes>& places, bool second) {
  FluxPoint out{};
  const PackMask known = add_loop(sample_loop(), packed(places), second, out);
  for (int l = 0; l < lanes; ++l) EXPECT_NE(known[l], 0) << l;
  return out;
}

Eigen::Vector3d of_lane(const Pack3& vector, int lane) {
  return {vector.x[lane], vector.y[lane], vector.z[lane]};
}

/// Biot-Savart around the wire; the trapezoidal rule of a periodic function.
Eigen::Vector3d integrated(const Eigen::Vector3d& place) {
  constexpr int pieces = 4000;
  const Eigen::Vector3d across = turned_about.unitOrthogonal(), other = turned_about.cross(across);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < pieces; ++i) {
    const double angle = 2 * std::numbers::pi * i / pieces;
    const Eigen::Vector3d wire = middle + ring * (std::cos(angle) * across + std::sin(angle) * other);
    const Eigen::Vector3d along = ring * (-std::sin(angle) * across + std::cos(angle) * other);
    const Eigen::Vector3d from = place - wire;
    sum += along.cross(from) / std::pow(from.norm(), 3);
  }
  return strength * 2 * std::numbers::pi / pieces * sum;
}

}  // namespace

TEST(LoopField, IsBiotAndSavarts) {
  const auto places = sample_places();
  const FluxPoint found = field_at(places, false);
  for (int l = 0; l < lanes; ++l) {
    const Eigen::Vector3d expected = integrated(places[l]);
    EXPECT_LT((of_lane(found.value, l) - expected).norm(), 1e-11 * expected.norm()) << l;
  }
}

/// Against differences of the field and of its slope; without second derivatives the rest is the same.
TEST(LoopField, HasTheseDerivatives) {
  const auto places = sample_places();
  const FluxPoint found = field_at(places, true), less = field_at(places, false);
  constexpr double step = 1e-4;
  for (int j = 0; j < 3; ++j) {
    auto before = places, after = places;
    for (int l = 0; l < lanes; ++l) {
      before[l][j] -= step;
      after[l][j] += step;
    }
    const FluxPoint low = field_at(before, false), high = field_at(after, false);
    for (int l = 0; l < lanes; ++l) {
      const double near = std::abs((places[l] - middle).norm() - ring), size = of_lane(found.value, l).norm();
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d slope = of_lane(found.slope.row[i], l);
        EXPECT_LT((slope - of_lane(less.slope.row[i], l)).norm(), 1e-12 * size / near) << l;
        const double difference = (of_lane(high.value, l) - of_lane(low.value, l))[i] / (2 * step);
        EXPECT_NEAR(slope[j], difference, 1e-5 * size / near) << l << " " << i << j;
        const Eigen::Vector3d second = of_lane(found.second[i].row[j], l);
        const Eigen::Vector3d change = (of_lane(high.slope.row[i], l) - of_lane(low.slope.row[i], l)) / (2 * step);
        EXPECT_LT((second - change).norm(), 1e-4 * size / (near * near)) << l << " " << i << j;
      }
    }
  }
}

/// It adds, so that loops make a coil; and it is not known on the wire.
TEST(LoopField, AddsAndTellsTheWire) {
  auto places = sample_places();
  FluxPoint twice = field_at(places, true);
  const FluxPoint once = twice;
  (void)add_loop(sample_loop(), packed(places), true, twice);
  for (int l = 0; l < lanes; ++l) {
    EXPECT_LT((of_lane(twice.value, l) - 2 * of_lane(once.value, l)).norm(), 1e-14 * of_lane(once.value, l).norm());
    EXPECT_LT((of_lane(twice.second[1].row[2], l) - 2 * of_lane(once.second[1].row[2], l)).norm(),
              1e-10 * of_lane(once.value, l).norm());
  }
  LoopOfCurrent flat{};
  flat.axis[2] = 1;
  flat.radius_mm = 2;
  flat.scale = 1;
  FluxPoint out{};
  for (Eigen::Vector3d& place : places) place = {1, 1, 1};
  places[5] = {0, 2, 0};
  const PackMask known = add_loop(flat, packed(places), false, out);
  for (int l = 0; l < lanes; ++l) EXPECT_EQ(known[l] != 0, l != 5) << l;
}

}  // namespace softkin::energy
