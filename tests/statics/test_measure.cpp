#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <numeric>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/statics/deformation.hpp>

#include "model/physical_robots.hpp"

namespace softkin {
namespace {

/// One body element of order 2: corners of the unit tetrahedron, its edges bulged by up to `bulge`.
Model quadratic_element(double bulge) {
  Model model;
  model.rest = Points::Zero(10, 3);
  for (int i = 0; i < 3; ++i) model.rest(i + 1, i) = 1;
  for (int e = 0; e < 6; ++e) {
    const auto& [i, j] = tetrahedron_edges[e];
    model.rest.row(4 + e) = 0.5 * (model.rest.row(i) + model.rest.row(j));
    model.rest.row(4 + e) += bulge * Eigen::RowVector3d(std::sin(e + 1), std::cos(3 * e), std::sin(5 * e + 2));
  }
  model.elements.tetrahedra = {{0, 1, 2, 3}};
  model.elements.edge_nodes = {{4, 5, 6, 7, 8, 9}};
  model.elements.tetrahedron_roles = {{0, -1, -1}};
  model.elements.tetrahedron_volumes = {
      shape_integrals(nodes_of(model.rest, {0, 1, 2, 3}, model.elements.edge_nodes[0])).sum()};
  model.elements.materials.resize(1);
  return model;
}

Points moved(const Points& rest, const Mat3& gradient) {
  return rest * gradient.transpose();
}

Mat3 some_gradient() {
  Mat3 f;
  f << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  return f;
}

TEST(Measure, AHomogeneousDeformationIsFoundInACurvedElement) {
  const Model model = quadratic_element(0.05);
  const Mat3 f = some_gradient();
  const ElementDeformation found = deformation_of(model, moved(model.rest, f));
  const Vec3 stretches = Eigen::JacobiSVD<Mat3>(f).singularValues();
  ASSERT_EQ(found.strain.size(), 1u);
  EXPECT_NEAR(found.volume_ratio[0], f.determinant(), 1e-12);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found.strain[0][i], stretches[i] - 1, 1e-12);
}

/// x -> x + bend with quadratic terms, which an element of order 2 represents exactly, and its gradient.
Vec3 bent_place(const Vec3& x) {
  return x + Vec3(0.3 * x.x() * x.y(), -0.2 * x.z() * x.z() + 0.1 * x.x() * x.z(), 0.4 * x.y() * x.y());
}
Mat3 bent_gradient(const Vec3& x) {
  Mat3 f = Mat3::Identity();
  f(0, 0) += 0.3 * x.y();
  f(0, 1) += 0.3 * x.x();
  f(1, 0) += 0.1 * x.z();
  f(1, 2) += -0.4 * x.z() + 0.1 * x.x();
  f(2, 1) += 0.8 * x.y();
  return f;
}

Points bent_all(const Points& rest) {
  Points positions(rest.rows(), 3);
  for (Index i = 0; i < rest.rows(); ++i) positions.row(i) = bent_place(rest.row(i).transpose()).transpose();
  return positions;
}

TEST(Measure, ABentElementCountsWithItsLeastVolumeAndLargestStrain) {
  const Model model = quadratic_element(0);
  const ElementDeformation found = deformation_of(model, bent_all(model.rest));
  const double far = (5 + 3 * std::sqrt(5.0)) / 20, near = (5 - std::sqrt(5.0)) / 20;  // Hammer and Stroud 1956
  double least = 2, magnitude = 0;
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d weights = Eigen::Vector4d::Constant(near);
    weights[i] = far;
    const Mat3 inside = bent_gradient(model.rest.topRows(4).transpose() * weights);
    least = std::min({least, inside.determinant(), bent_gradient(model.rest.row(i).transpose()).determinant()});
    const Vec3 stretches = Eigen::JacobiSVD<Mat3>(inside).singularValues();
    magnitude = std::max({magnitude, std::abs(stretches[0] - 1), std::abs(stretches[2] - 1)});
  }
  EXPECT_NEAR(found.volume_ratio[0], least, 1e-12);
  EXPECT_NEAR(std::max(std::abs(found.strain[0][0]), std::abs(found.strain[0][2])), magnitude, 1e-12);
  EXPECT_GT(magnitude, 0.1);
}

TEST(Measure, AnElementThatFoldsAtACornerIsInverted) {
  const Model model = quadratic_element(0);
  Points positions = model.rest;
  const ElementDeformation whole = deformation_of(model, positions);
  EXPECT_NEAR(whole.volume_ratio[0], 1, 1e-12);
  positions.row(4) = 0.76 * positions.row(1);  // beyond three quarters of the edge 01 the map turns back at its end
  EXPECT_LT(deformation_of(model, positions).volume_ratio[0], 0);
  positions.row(4) = 0.74 * model.rest.row(1);
  EXPECT_GT(deformation_of(model, positions).volume_ratio[0], 0);
}

TEST(Measure, AChamberOfOrderTwoIsMeasuredByItsBoundary) {
  Model model = quadratic_element(0.05);
  Actuator air;
  auto& chamber = air.drive.emplace<ChamberDrive>();
  const Tetrahedron& t = model.elements.tetrahedra[0];
  for (const auto& corners : tetrahedron_faces) {
    CavityFace face;
    for (std::size_t i = 0; i < 3; ++i) {
      face.corners[i] = t[corners[i]];
      face.edges[i] = edge_node(t, model.elements.edge_nodes[0], t[corners[i]], t[corners[(i + 1) % 3]]);
    }
    chamber.cavity.push_back(face);
  }
  air.rest_measure = model.elements.tetrahedron_volumes[0];
  EXPECT_NEAR(achieved_ratio(model, air, model.rest), 1, 1e-12);
  const Points positions = bent_all(model.rest);
  const double volume = shape_integrals(nodes_of(positions, t, model.elements.edge_nodes[0])).sum();
  EXPECT_NEAR(achieved_ratio(model, air, positions), volume / air.rest_measure, 1e-12);
  EXPECT_GT(std::abs(volume / air.rest_measure - 1), 0.01);
  EXPECT_NEAR(achieved_ratio(model, air, moved(model.rest, some_gradient())), some_gradient().determinant(), 1e-12);
}

TEST(Measure, ASurfaceIsMeasuredByItself) {
  const Model model = quadratic_element(0);
  Actuator air;
  auto& chamber = air.drive.emplace<ChamberDrive>();
  for (const Index v : {0, 1, 2, 3}) chamber.points.push_back({{v}, {1}, 0});
  for (const auto& [a, b, c] : tetrahedron_faces) chamber.surface.push_back({a, b, c});
  air.rest_measure = 17;  // of elements that fill it only roughly
  EXPECT_NEAR(achieved_ratio(model, air, model.rest), 1, 1e-12);
  EXPECT_NEAR(achieved_ratio(model, air, 1.5 * model.rest), 1.5 * 1.5 * 1.5, 1e-12);
}

/// Two prisms side by side, the first of them a dea of the material of both.
Model half_a_membrane() {
  Model model;
  model.rest = Points(8, 3);
  model.rest << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1;
  model.elements.prisms = {{0, 1, 2, 4, 5, 6}, {1, 3, 2, 5, 7, 6}};
  model.elements.prism_roles = {{0, 0, -1}, {0, -1, -1}};
  model.elements.prism_volumes = {0.5, 0.5};
  model.elements.materials.resize(1);
  model.elements.materials[0].region = "skin";
  model.elements.materials[0].linear_range = 0.1;
  return model;
}

/// A wall that is stretched by half in its plane and becomes much thinner: both strains are reported, whichever is
/// larger.
TEST(Measure, LeastAndGreatestStrainAreOfAllDirections) {
  for (const bool order_2 : {false, true}) {
    RobotSpec spec = testing::physical_robot(testing::block_mesh({2, 2, 1}, {8, 8, 1}));
    spec.mesh_options.quadratic = order_2;
    const Model model = compile(spec);
    Points positions = model.rest * Vec3(1.5, 1.5, 0.443).asDiagonal();
    StrainHistogram found = strain_histogram(model, deformation_of(model, positions));
    EXPECT_NEAR(found.greatest, 0.5, 1e-12);
    EXPECT_NEAR(found.least, -0.557, 1e-12);
    EXPECT_NEAR(found.percentile_95, 0.557, 1e-12);
    EXPECT_EQ(found.fractions.size(), 1u) << "the histogram counts an element by its largest magnitude";
    if (!order_2) continue;
    positions.col(0) += 0.1 * model.rest.col(0).cwiseAbs2();  // stretched most at the far end, by the derivative there
    found = strain_histogram(model, deformation_of(model, positions));
    const double far = (5 + 3 * std::sqrt(5.0)) / 20, near = (5 - std::sqrt(5.0)) / 20;  // Hammer and Stroud 1956
    double last = 0;  // place along x of the point that is farthest along
    for (const Tetrahedron& t : model.elements.tetrahedra)
      for (int i = 0; i < 4; ++i) {
        double x = 0;
        for (int k = 0; k < 4; ++k) x += (k == i ? far : near) * model.rest(t[k], 0);
        last = std::max(last, x);
      }
    EXPECT_NEAR(found.greatest, 0.5 + 0.2 * last, 1e-9);
    EXPECT_NEAR(found.least, -0.557, 1e-9);
  }
}

TEST(Measure, TheStrainOfADeaIsNotThatOfTheBody) {
  const Model model = half_a_membrane();
  Points positions = model.rest;
  positions.row(0) += Eigen::RowVector3d(-1, -1, 0);  // of the dea alone
  positions.row(4) += Eigen::RowVector3d(-1, -1, 0);
  for (const Index v : {3, 7}) positions.row(v) *= 1.2;
  const StrainHistogram found = strain_histogram(model, deformation_of(model, positions));
  EXPECT_GT(found.greatest, 0.1);
  EXPECT_LT(found.greatest, 0.6) << "the dea counts";
  EXPECT_EQ(found.fractions.size(), 1u) << "there is one element";
  EXPECT_NEAR(std::accumulate(found.fractions.begin(), found.fractions.end(), 0.0), 1, 1e-12);
  ASSERT_EQ(found.beyond.size(), 1u);
  EXPECT_EQ(found.beyond[0].fraction, 1);

  Model all_dea = model;
  all_dea.elements.prism_roles[1].actuator = 0;
  const StrainHistogram none = strain_histogram(all_dea, deformation_of(all_dea, positions));
  EXPECT_TRUE(none.fractions.empty());
  EXPECT_TRUE(none.beyond.empty());
}

}  // namespace
}  // namespace softkin
