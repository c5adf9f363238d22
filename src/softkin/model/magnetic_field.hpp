#pragma once

#include <softkin/core/error.hpp>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

/// What a material's remanent flux density is, in the frame of the robot at rest [mT]: one for all of it, or one for
/// every element of the mesh, tetrahedra before prisms.
struct RemanenceSpec {
  Vec3 uniform{0, 0, 0};
  std::vector<Vec3> of_elements;  // empty: uniform
};

/// An applied magnetic field as the user describes it.
struct FieldSpec {
  Vec3 direction{0, 0, 0};  // of a uniform field whose flux density is commanded
};

/// What is magnetic in a compiled robot, and the fields that act on it.
struct Magnetism {
  std::vector<Vec3> remanence;  // of every tetrahedron, then prism, of the model [mT]
};

}  // namespace softkin
