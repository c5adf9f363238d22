#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <utility>

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

/// Time left at the pace of late: work that slows down says so, instead of promising what its beginning did.
class TimeLeft {
 public:
  /// seconds  since the work began
  /// share    of it that is done, 0 to 1
  /// returns  [s]; none before there is a pace, and where the work stands still
  [[nodiscard]] std::optional<double> at(double seconds, double share);

 private:
  std::deque<std::pair<double, double>> seen_;
};

}  // namespace softkin
