#pragma once

#include <softkin/statics/statics.hpp>

#include "model/physical_robots.hpp"
#include "statics/robots.hpp"

namespace softkin::testing {

inline ElasticSpec elastic(Law law, double e, double nu) {
  ElasticSpec spec;
  spec.law = law;
  if (law == Law::gent) {
    spec.shear_modulus = e / (2 * (1 + nu));
    spec.jm = 30;
  } else if (law == Law::ogden) {
    const double shear = e / (2 * (1 + nu));
    spec.ogden = {{0.64 * shear, 2.5}, {-0.4 / 1.5 * shear, -1.5}};
  } else if (forbids_inversion(law)) {
    spec.c10 = e / (4 * (1 + nu));
    if (law == Law::mooney_rivlin) spec.c01 = 0;
  } else {
    spec.youngs_modulus = e;
  }
  spec.poisson_ratio = nu;
  return spec;
}

inline ActuatorSpec cable(const std::string& name, std::vector<Vec3> points, double low = 0.3, double high = 1.5) {
  ActuatorSpec spec = actuator(name, CableSpec{}, low, high, true);
  for (const Vec3& point : points) spec.as<CableSpec>()->points.push_back({point, {}});
  return spec;
}

inline ActuatorSpec air(const std::string& region, double low = 0.3, double high = 10) {
  ActuatorSpec spec = actuator(region, PneumaticSpec{.region = region}, low, high, true);
  return spec;
}

/// The same actuator, commanded by its tension or pressure.
inline ActuatorSpec by_load(ActuatorSpec spec, double low = -1e4, double high = 1e4) {
  spec.control = Control::load;
  spec.low = spec.is<CableSpec>() ? 0 : low;
  spec.high = high;
  spec.rest = 0;
  return spec;
}

/// A beam of 60 x 12 x 16 mm with a chamber in its upper half, fixed at x = 0; inflated it bends down.
inline RobotSpec bending_finger() {
  Mesh mesh = block_mesh({12, 3, 4}, {60, 12, 16});
  add_volume_region(mesh, "chamber", [](const Vec3& p) {
    return p.x() > 5 && p.x() < 55 && p.y() > 4 && p.y() < 8 && p.z() > 8 && p.z() < 12;
  });
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.actuators = {air("chamber")};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

/// 48 x 18 x 24 mm around an empty space of 24 x 6 x 6 mm, with bags whose surface lies 2 mm farther along x than the
/// space, so that it cuts through elements.
inline RobotSpec robot_with_bags(const std::vector<std::string>& names) {
  RobotSpec spec = physical_robot(block_mesh({8, 3, 4}, {48, 18, 24}));
  spec.voids.push_back({Box{{12, 6, 12}, {36, 12, 18}}, {}});
  for (const std::string& name : names) {
    ActuatorSpec bag = air(name);
    bag.as<PneumaticSpec>()->region.reset();
    bag.as<PneumaticSpec>()->surface = box_surface({14, 6, 12}, {24, 6, 6});
    spec.actuators.push_back(bag);
  }
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

/// A beam of 60 x 10 x 10 mm with cables along its top and its bottom.
inline RobotSpec cable_beam() {
  RobotSpec spec = physical_robot(block_mesh({12, 2, 2}, {60, 10, 10}));
  const auto along = [](double z) { return std::vector<Vec3>{{0, 5, z}, {20, 5, z}, {40, 5, z}, {60, 5, z}}; };
  spec.actuators = {cable("top", along(9)), cable("bottom", along(1))};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

/// A ball around a hollow, its radius [mm]: a cube of cells pushed onto spheres. Region "hollow" is the inside; three
/// vertices hold it without force.
inline RobotSpec hollow_ball(int cells, double diameter, double hollow) {
  const std::array<int, 3> all{cells, cells, cells};
  const Vec3 center = Vec3::Constant(diameter / 2);
  Mesh mesh = block_mesh(all, Vec3::Constant(diameter));
  add_volume_region(mesh, "hollow", [&](const Vec3& p) { return (p - center).cwiseAbs().maxCoeff() < hollow; });
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    const Vec3 p = mesh.vertices.row(v).transpose() - center;
    mesh.vertices.row(v) = (p.norm() > 0 ? Vec3(p * p.cwiseAbs().maxCoeff() / p.norm()) : p).transpose();
  }
  RobotSpec spec = physical_robot(std::move(mesh));
  const int middle = cells / 2;
  spec.fixed = {{{VertexList{{grid_vertex(all, 0, middle, middle)}}, {}}, {true, true, true}},
                {{VertexList{{grid_vertex(all, cells, middle, middle)}}, {}}, {false, true, true}},
                {{VertexList{{grid_vertex(all, middle, 0, middle)}}, {}}, {false, false, true}}};
  return spec;
}

/// Fingers of two and three chambers side by side around the axis.
inline RobotSpec chambers_beam(int count) {
  Mesh mesh = block_mesh({8, 5, 5}, {48, 20, 20});
  const double places[3][2] = {{4, 4}, {12, 4}, {8, 12}};
  for (int i = 0; i < count; ++i)
    add_volume_region(mesh, "chamber" + std::to_string(i + 1), [&](const Vec3& p) {
      return p.x() > 6 && p.x() < 42 && p.y() > places[i][0] && p.y() < places[i][0] + 4 && p.z() > places[i][1] &&
             p.z() < places[i][1] + 4;
    });
  RobotSpec spec = physical_robot(std::move(mesh));
  for (int i = 0; i < count; ++i) spec.actuators.push_back(air("chamber" + std::to_string(i + 1)));
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

inline StaticsOptions tight(double tolerance_mm = 1e-9) {
  StaticsOptions options;
  options.step_tolerance_mm = tolerance_mm;
  return options;
}

/// From rest, converged.
inline Equilibrium solve_converged(const Statics& statics, const Actuation& actuation,
                                   const StaticsOptions& options = tight()) {
  Equilibrium found = statics.solve(actuation, statics.rest(), options);
  EXPECT_EQ(found.report.status, Status::converged) << found.report.remark << " at " << found.report.reached;
  EXPECT_TRUE(found.state.positions.allFinite());
  return found;
}

inline double distance(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().maxCoeff();
}

inline Vec3 marker_at(const Model& model, const Equilibrium& found, std::size_t index = 0) {
  return model.markers[index].point.at(found.state.positions);
}

}  // namespace softkin::testing
