#pragma once

#include <softkin/kinematics/goal.hpp>
#include <softkin/model/equilibrium.hpp>
#include <string>

namespace softkin::cli {

/// The actuation of the sample of a workspace at which the goals are nearest to being met.
///
/// throws  InvalidInput naming --workspace, or file and line: no workspace of this robot, no sample with an equilibrium
[[nodiscard]] Actuation nearest_actuation(const Model& model, const std::string& workspace,
                                          const std::vector<Goal>& goals);

}  // namespace softkin::cli
