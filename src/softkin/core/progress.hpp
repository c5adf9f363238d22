#pragma once

#include <functional>

namespace softkin {

/// What a long computation tells while it runs.
struct Progress {
  int iteration = 0;
  double step_mm = 0;       // largest move of a vertex in the last iteration [mm]
  double tolerance_mm = 0;  // the step at which it stops [mm]
  double share = -1;        // of the way to what was asked for, at the last equilibrium on it [-]; < 0: not known
};

/// Called now and then; returning false stops the computation, which then reports status interrupted.
using ProgressCallback = std::function<bool(const Progress&)>;

}  // namespace softkin
