#pragma once

#include <softkin/model/model.hpp>
#include <softkin/runs/records.hpp>
#include <string>

namespace softkin::runs {

/// What is told of a finding, a line.
[[nodiscard]] std::string finding_text(const Model& model, const Finding& finding);

/// "0.31 mm at (1.20, 0.00, 3.00) mm" of the deepest point of an overlap.
[[nodiscard]] std::string depth_text(double deepest_mm, const Vec3& where);

/// Why parts of the robot can be in each other.
[[nodiscard]] std::string overlap_cause(const Model& model);

}  // namespace softkin::runs
