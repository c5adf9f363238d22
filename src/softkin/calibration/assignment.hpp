#pragma once

#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::calibration {

/// Pairs of rows and columns, each in one pair at most, with the least sum of costs, where a row without a pair costs
/// `alone`.
///
/// costs    rows by columns, >= 0; infinite: no pair
/// alone    >= 0, finite
/// returns  the column of each row; -1: none
/// source   Kuhn 1955, Munkres 1957; by shortest augmenting paths, Jonker and Volgenant 1987:
///          O(rows^2 (rows + columns))
[[nodiscard]] std::vector<Index> min_assignment(const Eigen::MatrixXd& costs, double alone);

}  // namespace softkin::calibration
