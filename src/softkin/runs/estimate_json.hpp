#pragma once

#include <softkin/io/json_text.hpp>
#include <softkin/kinematics/estimator.hpp>

namespace softkin::runs {

// What readings told as JSON; keys name the units. In reports and in what is streamed.

/// Rows of a matrix.
[[nodiscard]] Json matrix_json(const Eigen::MatrixXd& matrix);
/// Of each number its name, unit, value and deviation, what was known before, and at which bound it is.
[[nodiscard]] Json told_numbers_json(const Estimate& told);
/// Of each place its force, where it is at rest and in the shape, and its covariance.
[[nodiscard]] Json told_places_json(const Estimate& told);
/// Names of the groups that were left out.
[[nodiscard]] Json left_out_json(const Estimate& told, const std::vector<ReadingGroup>& groups);
/// Beside each reading what was computed, and its deviation. values: of the columns; NaN: not read, and not told
[[nodiscard]] Json read_json(const Estimate& told, const std::vector<PoseColumn>& columns,
                             const Eigen::VectorXd& values);

}  // namespace softkin::runs
