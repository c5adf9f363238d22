#pragma once

#include "statics/physical_samples.hpp"

namespace softkin::testing {

/// Derivatives by a command from converged equilibria on one or both sides.
struct Difference {
  Points positions;             // #V by 3 [mm per unit of command]
  Eigen::VectorXd multipliers;  // m [N or kPa per unit of command]
};

/// Weighted sum of equilibria at actuation + offsets[k] along the axis of one actuator, each solved from `at`.
inline Difference weighted_equilibria(const Statics& statics, const State& at, Index actuator,
                                      const std::vector<double>& offsets, const std::vector<double>& weights,
                                      double tolerance_mm = 1e-9) {
  Difference sum{Points::Zero(at.positions.rows(), 3), Eigen::VectorXd::Zero(at.actuation.size())};
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    Actuation moved = at.actuation;
    moved[actuator] += offsets[k];
    const Equilibrium found = statics.solve(moved, at, tight(tolerance_mm));
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    sum.positions += weights[k] * found.state.positions;
    sum.multipliers += weights[k] * found.state.multipliers;
  }
  return sum;
}

/// Central differences of fourth order.
inline Difference central(const Statics& statics, const State& at, Index actuator, double step,
                          double tolerance_mm = 1e-9) {
  const double h = 1 / (12 * step);
  return weighted_equilibria(statics, at, actuator, {-2 * step, -step, step, 2 * step}, {h, -8 * h, 8 * h, -h},
                             tolerance_mm);
}

/// One-sided differences of fourth order, towards the sign of step.
inline Difference one_sided(const Statics& statics, const State& at, Index actuator, double step,
                            double tolerance_mm = 1e-9) {
  const double h = 1 / (12 * step);
  return weighted_equilibria(statics, at, actuator, {0, step, 2 * step, 3 * step, 4 * step},
                             {-25 * h, 48 * h, -36 * h, 16 * h, -3 * h}, tolerance_mm);
}

/// Largest entry of a - b over the largest of b.
template <class A, class B>
double off_by(const A& a, const B& b) {
  const double size = b.cwiseAbs().maxCoeff(), error = (a - b).cwiseAbs().maxCoeff();
  return error == 0 ? 0 : error / size;
}

}  // namespace softkin::testing
