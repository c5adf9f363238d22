#pragma once

#include <cstddef>
#include <optional>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

/// Measured ratios of chambers that squeeze each other, each a function of all pressures: on a grid, linear in every
/// pressure between its values; nothing is extrapolated.
struct CoupledCurves {
  std::string file;                                // for messages
  std::vector<std::size_t> chambers;               // actuators of the model
  std::vector<std::vector<double>> pressures_kPa;  // per chamber the grid's values, ascending, at least two; gauge
  std::vector<Eigen::VectorXd> ratios;             // per node, the last chamber's pressure fastest; per chamber [-]

  /// The node of these places on the axes.
  [[nodiscard]] std::size_t node(const std::vector<std::size_t>& places) const;
  /// throws  InvalidInput naming the file outside the grid
  [[nodiscard]] Eigen::VectorXd ratios_at(const Eigen::VectorXd& kPa) const;
  /// Returns all pressures inside the grid that lead to these ratios, within rounding: none outside the measured range,
  /// several where the measured ratios are not unique.
  [[nodiscard]] std::vector<Eigen::VectorXd> pressures_for(const Eigen::VectorXd& requested) const;
};

}  // namespace softkin
