#include "workspace_start.hpp"

#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/nearest.hpp>
#include <softkin/statics/statics.hpp>
#include <utility>

#include <softkin/model/fingerprint.hpp>
#include "workspace_columns.hpp"

namespace softkin::cli {

Actuation nearest_actuation(const Model& model, const std::string& workspace, const std::vector<Goal>& goals) {
  WorkspaceTable table = read_workspace(workspace, workspace_columns(model));
  const auto robot =
      std::find_if(table.head.begin(), table.head.end(), [](const auto& entry) { return entry.first == "robot"; });
  if (robot == table.head.end() || robot->second != fingerprint_of(model))
    throw InvalidInput("--workspace " + workspace +
                       ": is of another robot, or of another formulation, or the scene or its mesh has changed");
  NearestSamples samples(model, std::move(table.samples));
  const Actuation actuation = samples.samples()[static_cast<std::size_t>(samples.find(goals).front())].actuation;
  check_actuation(model, actuation);  // the ranges may have changed
  return actuation;
}

}  // namespace softkin::cli
