#pragma once

#include <nlohmann/json.hpp>
#include <softkin/kinematics/hull.hpp>
#include <softkin/model/workspace_sample.hpp>

#include "workspace_options.hpp"

namespace softkin::cli {

/// What a finished workspace shows of one marker.
class WorkspaceReach {
 public:
  /// samples: in order; those without an equilibrium are left out.
  WorkspaceReach(const Model& model, std::vector<WorkspaceSample> samples, const WorkspaceOptions& options);

  /// Writes --cloud, --hull and --plot. A hull without a volume or an area is told, not written.
  void write();

  /// "tip reaches x 20.1 to 118.3, ... mm", the hull and the files, a line each.
  [[nodiscard]] std::string text() const;
  /// Adds reach_mm, hull and the files.
  void add_to(nlohmann::ordered_json& json) const;

 private:
  void write_cloud() const;
  void write_hull();
  void write_plot() const;

  const Model& model_;
  const WorkspaceOptions& options_;
  std::vector<WorkspaceSample> samples_;  // with equilibria
  std::string marker_;
  Points positions_;  // of the marker
  Hull hull_;
};

/// throws  InvalidInput on a robot without markers or an unknown name
[[nodiscard]] Index shown_marker(const Model& model, const std::string& name);

}  // namespace softkin::cli
