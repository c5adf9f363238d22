#pragma once

#include <cstddef>
#include <softkin/model/actuator_curve.hpp>
#include <vector>

namespace softkin::calibration {

/// Rows from one turning point of what drives a test to the next, both included.
struct Sweep {
  std::size_t begin = 0, end = 0;  // [begin, end)
  Branch branch = Branch::loading;
};

/// Cuts a test where its drive turns. A turn is a retreat by more than a tenth of the drive's range: smaller ones are
/// noise. Rows before the first turn and after the last are sweeps as well.
///
/// drive    what the experimenter moves, row by row in time; finite
/// returns  none where the drive does not change
[[nodiscard]] std::vector<Sweep> sweeps_of(const std::vector<double>& drive);

}  // namespace softkin::calibration
