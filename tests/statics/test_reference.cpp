#include <fstream>
#include <softkin/energy/rotation.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/statics.hpp>

#include "statics/robots.hpp"
#include "support/skips.hpp"

namespace softkin {

namespace {

Points read_xyz(const std::filesystem::path& path, Index count) {
  std::ifstream stream(path);
  Points points(count, 3);
  for (Index i = 0; i < count; ++i) stream >> points(i, 0) >> points(i, 1) >> points(i, 2);
  EXPECT_TRUE(stream.good());
  return points;
}

/// b moved rigidly onto a, best fit.
Points aligned(const Points& a, const Points& b) {
  const Eigen::RowVector3d center_a = a.colwise().mean(), center_b = b.colwise().mean();
  const Mat3 correlation = (a.rowwise() - center_a).transpose() * (b.rowwise() - center_b);
  const Mat3 r = energy::best_rotation(correlation);
  return ((b.rowwise() - center_b) * r.transpose()).rowwise() + center_a;
}

}  // namespace

/// Three-chamber actuator, chamber 1 to twice its volume, every element of it by the same ratio, w = 5. Nothing is held
/// but three vertices, statically determinate.
TEST(Reference, ThreeChamberFixedPoint) {
  const std::filesystem::path folder = testing::reference_folder() / "target-shape";
  SKIP_WITHOUT_REFERENCE((folder / "robot3_s.tet").string());
  RobotSpec spec;
  spec.mesh = read_tet(folder / "robot3_s.tet");
  MaterialSpec body;
  body.region = "all";
  spec.materials = {body};
  for (int chamber = 1; chamber <= 3; ++chamber) {
    ActuatorSpec air = testing::actuator("air" + std::to_string(chamber),
                                         PneumaticSpec{.region = "chamber" + std::to_string(chamber)}, 0.5, 3, false);
    spec.actuators.push_back(air);
  }
  Index far_along_y = 0, across = 0;
  const auto& v = spec.mesh.vertices;
  for (Index i = 0; i < v.rows(); ++i) {
    if ((v.row(i) - v.row(0)).cwiseAbs()[1] > (v.row(far_along_y) - v.row(0)).cwiseAbs()[1]) far_along_y = i;
    if ((v.row(i) - v.row(0)).cwiseAbs()[0] > (v.row(across) - v.row(0)).cwiseAbs()[0]) across = i;
  }
  spec.fixed = {{{VertexList{{0}}, {}}, {true, true, true}},
                {{VertexList{{far_along_y}}, {}}, {true, false, true}},
                {{VertexList{{across}}, {}}, {false, false, true}}};
  const Model model = compile(spec);
  EXPECT_EQ(model.elements.tetrahedra.size(), 24412u);
  const Statics statics(model);
  StaticsOptions options;
  options.step_tolerance_mm = 1e-8;
  options.anderson = 10;
  const Equilibrium found = statics.solve((Actuation(3) << 2, 1, 1).finished(), statics.rest(), options);
  EXPECT_EQ(found.report.status, Status::converged);
  const Points reference = read_xyz(folder / "robot3_s_w5_alpha2-1-1.xyz", model.rest.rows());
  const double distance = (aligned(reference, found.state.positions) - reference).rowwise().norm().maxCoeff();
  RecordProperty("largest_distance_mm", std::to_string(distance));
  EXPECT_LT(distance, 1e-4);
  EXPECT_NEAR(achieved_ratio(model, model.actuators[0], found.state.positions), 1.735, 5e-4);
}

}  // namespace softkin
