#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <softkin/model/mesh/refine_surface.hpp>
#include <softkin/statics/deformation.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

/// The robot with its chamber void and the surface in its place.
RobotSpec with_surface(RobotSpec spec, const TriangleSurface& surface) {
  spec.voids.push_back({*spec.actuators[0].as<PneumaticSpec>()->region, {}});
  spec.actuators[0].as<PneumaticSpec>()->region.reset();
  spec.actuators[0].as<PneumaticSpec>()->surface = surface;
  return spec;
}

TriangleSurface cut(const TriangleSurface& surface, double edge) {
  return refined(
      surface, [=](const Vec3&) { return edge; }, 100000);
}

double pressure_at(const RobotSpec& spec, double ratio) {
  const Model model = compile(spec);
  const Statics statics(model);
  return solve_converged(statics, values({ratio})).state.multipliers[0];
}

double ratio_at(RobotSpec spec, double pressure) {
  spec.actuators[0] = by_load(spec.actuators[0]);
  const Model model = compile(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({pressure}));
  return achieved_ratio(model, model.actuators[0], found.state.positions);
}

/// A rod of 40 mm length and 20 mm diameter with a round chamber of 12 mm diameter, twelve-cornered in the mesh.
RobotSpec round_finger() {
  Mesh mesh = block_mesh({8, 5, 5}, {40, 20, 20});
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    const Eigen::Vector2d p(mesh.vertices(v, 1) - 10, mesh.vertices(v, 2) - 10);
    if (p.norm() > 0) mesh.vertices.row(v).tail<2>() = (p * p.cwiseAbs().maxCoeff() / p.norm()).transpose();
  }
  add_volume_region(mesh, "chamber", [](const Vec3& p) { return p.x() > 5 && p.x() < 35 && p.tail<2>().norm() < 5.9; });
  mesh.regions.back().tetrahedra.clear();
  const Mesh square = block_mesh({8, 5, 5}, {40, 20, 20});
  for (std::size_t i = 0; i < square.tetrahedra.size(); ++i) {
    Vec3 p = Vec3::Zero();
    for (const Index v : square.tetrahedra[i]) p += 0.25 * vertex_at(square.vertices, v);
    if (p.x() > 5 && p.x() < 35 && (p.tail<2>().array() - 10).abs().maxCoeff() < 6)
      mesh.regions.back().tetrahedra.push_back(i);
  }
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.actuators = {air("chamber")};
  return spec;
}

/// Returns a cylinder along x with a polygon as its cross-section.
TriangleSurface cylinder(double start, double end, double radius, int corners) {
  TriangleSurface surface{Points(2 * corners + 2, 3), {}};
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / corners;
    const double y = radius * std::cos(angle), z = radius * std::sin(angle);
    surface.vertices.row(2 * i) << start, y, z;
    surface.vertices.row(2 * i + 1) << end, y, z;
    const Index a = 2 * i, b = a + 1, c = 2 * ((i + 1) % corners), d = c + 1, first = 2 * corners, last = first + 1;
    surface.triangles.insert(surface.triangles.end(), {{a, c, b}, {c, d, b}, {first, c, a}, {last, b, d}});
  }
  surface.vertices.bottomRows(2) << start, 0, 0, end, 0, 0;
  return surface;
}

}  // namespace

/// As the chamber's region, whatever the facets of the surface.
TEST(PhysicalCavities, ASurfaceTakesThePressureThatItsRegionTakes) {
  const TriangleSurface box = box_surface({5, 4, 8}, {50, 4, 4});
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = bending_finger();
    spec.mesh_options.quadratic = quadratic;
    const double pressure = pressure_at(spec, 1.3), ratio = ratio_at(spec, 100);
    for (const TriangleSurface& surface : {box, cut(box, 5)}) {
      EXPECT_NEAR(pressure_at(with_surface(spec, surface), 1.3), pressure, 1e-6 * pressure);
      EXPECT_NEAR(ratio_at(with_surface(spec, surface), 100), ratio, 1e-6);
    }
  }
}

TEST(PhysicalCavities, ARoundSurfaceOfAnyFineness) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = round_finger();
    spec.mesh_options.quadratic = quadratic;
    const double pressure = pressure_at(spec, 1.2);
    for (const int corners : {8, 12, 60})
      EXPECT_NEAR(pressure_at(with_surface(spec, cylinder(5, 35, 6, corners)), 1.2), pressure, 1e-6 * pressure);
  }
}

/// The chamber of half a robot ends at the plane of symmetry, where no element closes it.
TEST(PhysicalCavities, HalfARobotTakesThePressureOfTheWhole) {
  const auto robot = [](int cells, std::array<bool, 3> high) {
    Mesh mesh = block_mesh({cells, 3, 3}, {6.0 * cells, 18, 18}, Split::five);
    add_volume_region(mesh, "chamber", [](const Vec3& p) {
      return p.x() > 12 && p.x() < 36 && (p.tail<2>().array() - 9).abs().maxCoeff() < 3;
    });
    RobotSpec spec = physical_robot(std::move(mesh));
    spec.fixed.push_back({{std::string("x_high"), {}}, high});
    spec.actuators = {air("chamber")};
    return spec;
  };
  for (const bool quadratic : {false, true}) {
    RobotSpec whole = robot(8, {true, true, true}), half = robot(4, {true, false, false});
    whole.mesh_options.quadratic = half.mesh_options.quadratic = quadratic;
    const double pressure = pressure_at(whole, 1.3);
    EXPECT_NEAR(pressure_at(half, 1.3), pressure, 1e-6 * pressure);
  }
}

/// A surface that ends 1 mm beyond an empty space, and so bounds none, is embedded: finer facets than those that
/// softkin makes change nothing.
TEST(PhysicalCavities, AnEmbeddedSurfaceIsFineEnough) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = physical_robot(block_mesh({6, 3, 4}, {30, 12, 16}));
    spec.mesh_options.quadratic = quadratic;
    spec.voids = {{Box{{5, 4, 8}, {25, 8, 12}}, {}}};
    spec.actuators = {air("air")};
    spec.actuators[0].as<PneumaticSpec>()->region.reset();
    const TriangleSurface box = box_surface({4, 4, 8}, {22, 4, 4}), fine = cut(box, 0.4);
    spec.actuators[0].as<PneumaticSpec>()->surface = box;
    EXPECT_LT(3 * compile(spec).actuators[0].as<ChamberDrive>()->surface.size(), fine.triangles.size());
    const double pressure = pressure_at(spec, 1.3);
    spec.actuators[0].as<PneumaticSpec>()->surface = fine;
    EXPECT_NEAR(pressure_at(spec, 1.3), pressure, 2e-3 * pressure) << "order " << (quadratic ? 2 : 1);
  }
}

}  // namespace softkin
