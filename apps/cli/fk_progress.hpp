#pragma once

#include <cstddef>
#include <softkin/core/progress.hpp>

#include "terminal.hpp"

namespace softkin::cli {

/// Steps done, time and time left, on the terminal.
class FkProgress {
 public:
  /// first: the step with which the work begins.
  FkProgress(std::size_t first, std::size_t steps);

  void begin_step(std::size_t step);
  void show(const Progress& progress);
  void clear() { line_.clear(); }

 private:
  [[nodiscard]] double share_of_moves(const Progress& progress) const;

  ProgressLine line_;
  std::size_t first_, steps_, step_;
  double start_;           // [s]
  double first_move_ = 0;  // of this step [mm]
  double share_ = 0;       // of this step
};

}  // namespace softkin::cli
