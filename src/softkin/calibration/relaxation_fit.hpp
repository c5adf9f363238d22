#pragma once

#include <map>
#include <optional>
#include <softkin/calibration/maxwell_element.hpp>
#include <softkin/model/measurements.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// A number that was fitted.
struct Estimate {
  double value = 0;                 // in the unit of what it is of
  std::optional<double> deviation;  // standard deviation; none: held, at a bound, or not determined by the data
};

/// What was fitted of a branch.
struct BranchEstimate {
  Estimate modulus_MPa, time_s;  // shear modulus; relaxation time
};

/// An element fitted with so many branches.
struct ElementFit {
  MaxwellElement element;                // branches by ascending time
  std::vector<Estimate> constants;       // of the law, in the order of constant_names
  std::vector<BranchEstimate> branches;  // as the element's
  std::optional<double> rms_stress_MPa;  // of what is left of stresses; none: none answered
  std::optional<double> rms_stretch;     // of stretches [-]
  double criterion = 0;                  // Bayesian information criterion: less is better
};

/// By what the number of branches was found.
enum class BranchCount {
  requested,    // given by the user
  repeats,      // the fewest whose misfit is that between repeated runs
  information,  // the fewest whose criterion no other number is below by more than 6
};

/// An element fitted to tests of relaxation, creep or cycles, and those with fewer branches that were tried.
struct RelaxationFit {
  std::vector<ElementFit> tried;                     // without branches, with one, ...
  std::size_t chosen = 0;                            // its number of branches
  BranchCount by = BranchCount::information;         // what chose the number
  double shortest_s = 0, longest_s = 0;              // range of relaxation times that the tests resolve
  std::optional<double> repeat_MPa, repeat_stretch;  // deviation between repeated runs; none: there are none
  /// The one that was chosen.
  [[nodiscard]] const ElementFit& best() const { return tried[chosen]; }
};

/// What is fitted to relaxation, creep and cyclic tests.
struct RelaxationOptions {
  Law law = Law::neo_hookean;             // or mooney_rivlin, yeoh, gent
  std::map<std::string, double> held{};   // constants that are not fitted, by name [MPa; jm: -]
  std::optional<std::size_t> branches{};  // exactly so many; none: as few as the tests carry
};

/// Fits the branches, and the constants of the law that are not fixed, by least squares of the responses: every row has
/// the same weight.
///
/// Relaxation times lie between the shortest interval of the rows (the 2nd percentile) and the longest run. The number
/// of branches grows from 0; each fit starts once from the one before and the time of a logarithmic grid that improves
/// it most, and once from non-negative least squares over the whole grid, whose neighbours are merged; from there all
/// constants, moduli and times are refined together. Residuals below 1e-4 of the responses (rms) count as noise.
/// There are three rows or more for every unknown.
///
/// source  criterion: BIC = N ln(squares / N) + p ln N; a difference above 6 is strong: Kass, Raftery 1995
/// throws  InvalidInput on fewer rows than constants, where no stretch differs from 1, or where the tests do not
///         determine the law's constants or show no modulus of the law above 0
[[nodiscard]] RelaxationFit fit_relaxation(const std::vector<RelaxationRun>& runs, const RelaxationOptions& options);

}  // namespace softkin::calibration
