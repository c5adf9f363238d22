#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/core/text.hpp>
#include <softkin/model/mesh/walls.hpp>

#include "statics/physical_samples.hpp"

/// What the warning of linear tetrahedra quotes, against loaded robots of order 1 and of order 2.

namespace softkin {
namespace {

using namespace testing;

/// A strip of 12 x 24 mm (thickness, width) bent to a quarter of a ring of radius 40 mm, with its inner vertices moved
/// at random by up to a fifth of a cell: none of the bars that the formula was fitted to.
RobotSpec arc(int across, double poisson_ratio, Split split) {
  constexpr double thickness = 12, width = 24, radius = 40;
  const double cell = thickness / across;
  const std::array<int, 3> cells{static_cast<int>(std::lround(radius * std::numbers::pi / 2 / cell)), 3 * across,
                                 across};
  Mesh mesh = block_mesh(cells, {1, width, thickness}, split);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-0.2 * cell, 0.2 * cell);
  for (Index i = 0; i < mesh.vertices.rows(); ++i) {
    const Vec3 p = vertex_at(mesh.vertices, i);
    const bool inner = p.x() > 0 && p.x() < 1 && p.y() > 0 && p.y() < width && p.z() > 0 && p.z() < thickness;
    const double by = inner ? 1 : 0;
    const double angle = p.x() * std::numbers::pi / 2 + by * shift(random) / radius;
    const double r = radius + p.z() + by * shift(random);
    mesh.vertices.row(i) << r * std::sin(angle), p.y() + by * shift(random), r * std::cos(angle);
  }
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.materials[0].elastic = elastic(Law::neo_hookean, 1, poisson_ratio);
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  spec.loads.forces.push_back({"f", {std::string("x_high"), {}}, {0, 0, -0.02}});
  return spec;
}

/// How far the tip goes.
double give(RobotSpec spec, bool quadratic) {
  spec.mesh_options.quadratic = quadratic;
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({}), {});
  return (marker_at(model, found) - model.markers[0].point.at(model.rest)).norm();
}

/// The percentage in the only warning; 0 without one.
double quoted(const RobotSpec& spec) {
  const std::vector<std::string> warnings = compile(spec).warnings;
  EXPECT_LE(warnings.size(), 1u);
  if (warnings.empty()) return 0;
  const std::size_t at = warnings[0].find("they are about ");
  EXPECT_NE(at, std::string::npos) << warnings[0];
  return at == std::string::npos ? 0 : std::stod(warnings[0].substr(at + 15)) / 100;
}

TEST(Locking, OfARobotThatTheFormulaWasNotFittedTo) {
  for (const auto& [split, across, poisson_ratio] :
       {std::tuple(Split::six, 2, 0.3), std::tuple(Split::six, 3, 0.4), std::tuple(Split::five, 3, 0.3)}) {
    SCOPED_TRACE(std::to_string(across) + " elements, Poisson's ratio " + number(poisson_ratio));
    const RobotSpec spec = arc(across, poisson_ratio, split);
    const double measured = give(spec, true) / give(spec, false) - 1;
    EXPECT_GT(measured, 0.1);
    EXPECT_NEAR(std::log(quoted(spec) / measured), 0, std::log(2.5)) << quoted(spec) << " for " << measured;
  }
}

TEST(Locking, IsToldWhereWallsAreThinInElements) {
  const auto warning = [](const RobotSpec& spec) {
    const std::vector<std::string> all = compile(spec).warnings;
    return all.empty() ? "" : all[0];
  };
  const RobotSpec one = physical_robot(block_mesh({8, 2, 1}, {48, 12, 6}));
  EXPECT_EQ(warning(one),
            "The walls that bend most are about 1.0 elements thick, of tetrahedra of order 1: where they bend they are "
            "more than twice as stiff as they should be; take 'mesh: {file: F, order: 2}'.");
  RobotSpec quadratic = one;
  quadratic.mesh_options.quadratic = true;
  EXPECT_EQ(warning(quadratic), "");
  RobotSpec chosen = one;
  chosen.mesh_options.linear_by_choice = true;
  EXPECT_EQ(warning(chosen), "");
  const std::vector<std::string> notes = compile(chosen).notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [&](const std::string& note) { return note == warning(one); }));
  RobotSpec target = one;
  target.formulation = Formulation::target_shape;
  target.materials[0].shape_ratio = 1;
  EXPECT_EQ(warning(target), "");
  // 3 elements through the thickness of 12 mm and 4 through the width of 16 mm, which bends less
  const std::string of_three = warning(physical_robot(block_mesh({12, 4, 3}, {48, 16, 12})));
  EXPECT_NE(of_three.find("about 3."), std::string::npos) << of_three;
  EXPECT_NE(of_three.find(" % too stiff"), std::string::npos) << of_three;
  RobotSpec fine = physical_robot(block_mesh({10, 10, 10}, {10, 10, 10}));
  fine.materials[0].elastic = elastic(Law::neo_hookean, 1, 0.0);
  EXPECT_EQ(warning(fine), "");
}

/// Returns the thickness of walls, in elements, that the only warning reports.
double reported_thickness(const RobotSpec& spec) {
  const std::vector<std::string> warnings = compile(spec).warnings;
  EXPECT_EQ(warnings.size(), 1u);
  return warnings.empty() ? 0 : std::stod(warnings[0].substr(warnings[0].find("about ") + 6));
}

/// A hinge of one element between thick links bends, not the links; unless it is rigid.
TEST(Locking, CountsWhatBends) {
  Mesh mesh = block_mesh({12, 4, 6}, {24, 8, 12});
  add_volume_region(mesh, "notch", [](const Vec3& p) { return p.x() > 10 && p.x() < 14 && p.z() > 2; });
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.voids.push_back({std::string("notch"), {}});
  EXPECT_LT(reported_thickness(spec), 1.5);
  spec.rigid.push_back({{Box{{10, 0, 0}, {14, 8, 2}}, {}}, "hinge"});
  EXPECT_GT(reported_thickness(spec), 3);
}

}  // namespace
}  // namespace softkin
