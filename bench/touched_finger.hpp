#pragma once

#include <softkin/model/model.hpp>

#include "model/block_mesh.hpp"

namespace softkin::bench {

constexpr double finger_length = 100;  // [mm]

/// A finger of about 6,000 linear tetrahedra, or 1,300 quadratic ones, with a chamber inside, held at x = 0; four
/// markers, none of which is on its back.
inline RobotSpec touched_finger(bool quadratic) {
  using testing::add_volume_region;
  using testing::block_mesh;
  RobotSpec spec;
  spec.name = "finger";
  const std::array<int, 3> cells = quadratic ? std::array<int, 3>{12, 5, 5} : std::array<int, 3>{24, 7, 7};
  spec.mesh = block_mesh(cells, {finger_length, 15, 20});
  add_volume_region(spec.mesh, "chamber", [](const Vec3& p) {
    return p.x() > 16 && p.x() < 84 && std::abs(p.y() - 7.5) < 3.3 && std::abs(p.z() - 10) < 4.4;
  });
  spec.formulation = Formulation::physical;
  spec.mesh_options.quadratic = quadratic;
  MaterialSpec material;
  material.region = "body";
  material.shape_ratio.reset();
  ElasticSpec elastic;
  elastic.youngs_modulus = 1;
  elastic.poisson_ratio = 0.45;
  material.elastic = elastic;
  spec.materials = {material};
  spec.fixed.push_back({{std::string("x_low"), {}}, {true, true, true}});
  ActuatorSpec air;
  air.name = "air";
  air.drive = PneumaticSpec{.region = "chamber"};
  air.control = Control::load;
  air.low = -20;
  air.high = 60;
  air.rest = 0;
  spec.actuators = {air};
  spec.loads.forces = {
      {"touch", {std::string("z_high"), {}}, {0, 0, 0}, std::array<Vec3, 2>{Vec3::Constant(-3), Vec3::Constant(3)}}};
  spec.markers = {{"m1", {Vec3(30, 0.5, 3), {}}},
                  {"m2", {Vec3(55, 14.5, 3), {}}},
                  {"m3", {Vec3(80, 0.5, 3), {}}},
                  {"m4", {Vec3(99, 14.5, 17), {}}}};
  return spec;
}

}  // namespace softkin::bench
