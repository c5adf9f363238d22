#pragma once

#include <softkin/io/json_text.hpp>
#include <softkin/kinematics/estimator.hpp>

namespace softkin::runs {

// Estimates from readings as JSON; keys name the units. In reports and in streams.

/// Rows of a matrix.
[[nodiscard]] Json matrix_json(const Eigen::MatrixXd& matrix);
/// Of each number its name, unit, value and deviation, what was known before, and at which bound it is.
[[nodiscard]] Json reported_numbers_json(const Estimate& reported);
/// Of each place its force, where it is at rest and in the shape, and its covariance.
[[nodiscard]] Json reported_places_json(const Estimate& reported);
/// Names of the groups that were left out.
[[nodiscard]] Json left_out_json(const Estimate& reported, const std::vector<ReadingGroup>& groups);
/// The computed value next to each reading, and its deviation. values: of the columns; NaN: not read, and left out
[[nodiscard]] Json read_json(const Estimate& reported, const std::vector<PoseColumn>& columns,
                             const Eigen::VectorXd& values);

}  // namespace softkin::runs
