#pragma once

#include <softkin/runs/records.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// What a user should know of an equilibrium beside its numbers.
struct Finding {
  enum class Kind {
    strain,               // values: least, greatest, 95th percentile of the magnitude [-]
    beyond_linear_range,  // name: region; values: share of its volume [-], its linear range [-]
    inverted,             // values: how many elements
    slack,                // name: cable; values: length of its path and of the cable over that at rest [-]
    diverged,             // the iteration
    accuracy              // values: last step, estimated distance from the equilibrium [mm]
  };
  Kind kind;
  std::string name{};
  std::vector<double> values{};
};

[[nodiscard]] std::vector<Finding> findings(const Model& model, const StepRecord& record);

/// An actuator that did not come as far as was asked, in its own unit.
struct Shortfall {
  Index actuator = -1;
  double reached = 0, asked = 0;
};

/// Where the shape of a step that did not converge falls short of what was asked; none where only loads or displaced
/// supports do (StepRecord::reached), or it is not known.
[[nodiscard]] std::vector<Shortfall> shortfalls(const Model& model, const StepRecord& record);

}  // namespace softkin::runs
