#pragma once

#include <softkin/model/equilibrium.hpp>

namespace softkin {

/// What is kept of one equilibrium of a sampled workspace.
struct WorkspaceSample {
  Index number = 0;
  Actuation actuation;            // m, as asked for
  Points markers{};               // #markers by 3 [mm]; no rows where status is not converged
  Eigen::VectorXd multipliers{};  // m: tension [N] or gauge pressure [kPa]; empty where status is not converged
  Status status = Status::not_converged;
  int iterations = 0;
};

}  // namespace softkin
