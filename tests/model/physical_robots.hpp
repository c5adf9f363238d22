#pragma once

#include "model/block_mesh.hpp"

namespace softkin::testing {

/// The mesh as a robot of one neo-Hookean material (E 1 MPa, nu 0.4), its face x = 0 fixed, without actuators.
inline RobotSpec physical_robot(Mesh mesh) {
  RobotSpec spec = block_robot(std::move(mesh));
  spec.formulation = Formulation::physical;
  ElasticSpec elastic;
  elastic.youngs_modulus = 1;
  elastic.poisson_ratio = 0.4;
  spec.materials[0].shape_ratio.reset();
  spec.materials[0].elastic = elastic;
  return spec;
}

}  // namespace softkin::testing
