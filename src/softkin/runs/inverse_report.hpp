#pragma once

#include <softkin/kinematics/inverse.hpp>
#include <softkin/runs/record_log.hpp>
#include <softkin/runs/records.hpp>

namespace softkin::runs {

/// A goal and what the user calls it: "tip", "base:tip".
struct NamedGoal {
  std::string name;
  Goal goal;
};

/// The equilibrium that inverse kinematics came to.
struct InverseRecord : StepRecord {
  double error_mm = 0;  // of the farthest goal
};

[[nodiscard]] InverseRecord inverse_record(const Model& model, const InverseResult& found,
                                           const ElementDeformation& deformation);

/// Where the marker of a goal, or the unit vector between its markers, is [mm, -].
[[nodiscard]] Vec3 place_of(const Model& model, const Goal& goal, const Points& positions);

/// The report of it: what was asked and what came of it, and the record; to be written to file at its finish().
[[nodiscard]] RecordLog inverse_report(const Model& model, const std::string& scene, const std::filesystem::path& file,
                                       const InverseOptions& options, const std::vector<NamedGoal>& goals,
                                       const InverseResult& found, const InverseRecord& record);

}  // namespace softkin::runs
