#pragma once

#include <cstddef>
#include <optional>
#include <softkin/model/actuator_curve.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// A measured point of an actuator's curve.
struct CurveSample {
  double input = 0;                 // gauge pressure [kPa] or voltage [kV]
  double ratio = 1;                 // volume or area over that without input [-]
  Branch branch = Branch::loading;  // of the sweep that it is of
  std::size_t repeat = 0;           // samples of one sweep have one number
};

/// How well a branch describes its samples.
struct BranchQuality {
  std::size_t samples = 0, repeats = 0;  // of the branch; sweeps that they are of
  double rms = 0;                        // of the samples' ratios around the curve [-]
  double largest = 0;                    // distance of a sample's ratio from the curve [-]
  std::optional<double> mean_error;      // standard error of the mean of the repeats, largest along the curve [-]
  std::size_t pooled = 0;                // points that were merged because the ratio fell with the input
};

/// Curves through the samples of each branch, and how well they fit.
struct CurveFit {
  CurveBranch loading;                               // of a rising input
  std::optional<CurveBranch> unloading;              // of a falling one; none: no samples
  BranchQuality loading_quality, unloading_quality;  // the latter meaningless without an unloading branch
};

/// Monotone curves through the samples of each branch.
///
/// Up to 15 different inputs in a branch are its points as they are (equal ones averaged). Of more, the points are at
/// most 15 local quadratic fits at even distances. Where they do not ascend, neighbours are pooled (isotonic
/// regression). A loading branch that begins within a twentieth of its range from input 0 begins at (0, 1), by the
/// definition of the ratio; an unloading branch that ends within a fiftieth of its range from 0 is continued to 0.
/// Spread: standard deviation, at each point, of the fits of single repeats, where at least two reach it.
///
/// throws  InvalidInput: no loading samples, a branch with fewer than two different inputs or whose ratio does not
///         rise with its input
[[nodiscard]] CurveFit fit_curve(const std::vector<CurveSample>& samples);

}  // namespace softkin::calibration
