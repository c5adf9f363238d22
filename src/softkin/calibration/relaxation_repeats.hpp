#pragma once

#include <optional>
#include <softkin/model/measurements.hpp>
#include <vector>

namespace softkin::calibration {

/// How far runs of the same test are from each other.
struct Repeats {
  double deviation = 0;      // of one row about the mean of its runs: stress [MPa], or stretch [-] where load_imposed
  std::size_t freedoms = 0;  // rows less means
};

/// Runs repeat each other that have as many rows, at times that agree within a thousandth, and what was imposed agrees
/// within a hundredth of its largest value. None where no run repeats another.
///
/// load_imposed  looks at these runs alone
[[nodiscard]] std::optional<Repeats> repeats_of(const std::vector<RelaxationRun>& runs, bool load_imposed);

}  // namespace softkin::calibration
