#pragma once

#include <softkin/model/equilibrium.hpp>
#include <softkin/model/magnetic_field.hpp>

#include "random/reference_elements.hpp"

namespace softkin::random_robots {

/// The uniform field and the dipoles that random robots have, as commanded; once more, with no code of the solver.
struct CommandedFields {
  CommandedFields(const Model& model, const State& state);
  [[nodiscard]] RealFlux at(const RealVec3& place) const;

  RealVec3 uniform = RealVec3::Zero();  // [mT]
  std::vector<DipoleField> dipoles;
};

}  // namespace softkin::random_robots
