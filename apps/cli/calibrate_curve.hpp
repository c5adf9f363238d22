#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <softkin/calibration/curve_fit.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <string>
#include <vector>

#include "mesh_text.hpp"

namespace softkin::cli {

/// A curve with what it was fitted to. samples and quality are empty for a computed curve.
struct FittedCurve {
  ActuatorCurve curve;
  calibration::BranchQuality loading, unloading;
  std::vector<calibration::CurveSample> samples;
};

/// "loading: 3 sweeps, 120 rows, 15 points, ...", a line for each branch.
[[nodiscard]] std::string quality_text(const FittedCurve& fitted);

/// Ratios of both branches at even inputs, with their spread, and the width of the hysteresis; then the inputs of even
/// ratios.
[[nodiscard]] std::string curve_table(const FittedCurve& fitted);

/// Samples and both branches.
[[nodiscard]] Plot curve_plot(const FittedCurve& fitted, const std::string& title);

[[nodiscard]] Json curve_json(const FittedCurve& fitted);

/// Throws InvalidInput where a file is given that does not end so.
void check_ending(const char* option, const std::string& file, const char* ending);

[[nodiscard]] CLI::Validator positive_number();

}  // namespace softkin::cli
