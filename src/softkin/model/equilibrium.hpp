#pragma once

#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

using Actuation = Eigen::VectorXd;

/// Where a search begins or ended.
struct State {
  Points positions;  // #V by 3 [mm]
};

enum class Status { converged, not_converged, interrupted };

struct IterationRecord {
  double energy = 0;         // before the step [mm^5]
  double step_mm = 0;        // largest move of a vertex [mm]
  double gradient_norm = 0;  // Euclidean norm of dE/dx before the step [mm^4]
};

struct SolveReport {
  Status status = Status::not_converged;
  std::string solver;
  int iterations = 0;
  double energy = 0;              // at the last shape evaluated [mm^5]
  double step_mm = 0;             // last step [mm]
  double tolerance_mm = 0;        // step at which the iteration stops [mm]
  double gradient_norm = 0;       // [mm^4]
  double estimated_error_mm = 0;  // distance from the fixed point that the small step may hide [mm]
  std::vector<IterationRecord> history;
  double seconds = 0;
};

struct Equilibrium {
  State state;
  Actuation actuation;
  SolveReport report;
};

}  // namespace softkin
