#pragma once

#include <functional>
#include <softkin/io/table/table.hpp>
#include <softkin/kinematics/reading_plan.hpp>
#include <string>

namespace softkin::runs {

/// Estimates from readings, row by row of their table.
struct EstimateReport {
  const Model& model;
  const MeasuredPoses& poses;
  std::vector<EstimatedUnknown> unknowns;
  std::array<double, readings> deviations{};  // of each kind of reading, in its unit
  double fade_s = 0;
  std::vector<ReadingGroup> groups{};
  std::vector<Estimate> reported{};               // without shapes and how they move
  std::vector<std::vector<std::string>> words{};  // of each
  bool interrupted = false;                       // some rows are missing
  bool planned = false;                           // was a plan requested
  std::vector<PlannedReading> plan{};

  /// Has every row converged, and does the model fit all of its readings?
  [[nodiscard]] bool good() const;
};

/// The unknowns to estimate, and the readings to estimate them from.
struct RequestedEstimates {
  const Model& model;
  const MeasuredPoses& poses;
  std::vector<EstimatedUnknown> unknowns;
  std::array<double, readings> deviations{};    // of each kind of reading, in its unit; 0: none is given
  std::array<std::string, readings> options{};  // that give these, for messages

  /// Throws InvalidInput on a reading of a kind whose deviation is not given, naming its option.
  [[nodiscard]] Eigen::VectorXd deviations_of_columns() const;
  /// Throws InvalidInput where a column commands an unknown.
  void refuse_commanded(const std::vector<Index>& reported) const;
};

/// Called after each row with its number, from 0, and its estimate.
using EstimateCallback = std::function<void(std::size_t row, const Estimate& reported)>;

/// Estimates from every row, in order.
///
/// throws  InvalidInput: what Estimator and AskedEstimates throw; fading without times
[[nodiscard]] EstimateReport estimate_poses(const RequestedEstimates& requested, const EstimatorOptions& how,
                                            const EstimateCallback& row, const ProgressCallback& progress);

/// The estimate of one row: numbers and places with their deviations, then remarks.
[[nodiscard]] std::string estimate_row_text(const EstimateReport& report, std::size_t row);
/// The prior knowledge, deviations, and the fit of all rows.
[[nodiscard]] std::string estimate_text(const EstimateReport& report);
[[nodiscard]] std::string estimate_json(const EstimateReport& report);
/// A line for each row: numbers, places, deviations, chi-square, what was left out.
[[nodiscard]] Table estimate_table(const EstimateReport& report);

}  // namespace softkin::runs
