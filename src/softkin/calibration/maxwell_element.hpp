#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/model/robot_spec.hpp>
#include <vector>

namespace softkin::calibration {

/// An elastic law and Maxwell branches in parallel, incompressible, under tension or compression along one axis.
///
/// The nominal stress P is that of the law plus, for every branch of modulus G and relaxation time tau,
///   P_i = G (l / a^2 - a / l^2),    da/dt = (l^2 / a - a^2 / l) / (3 tau),
/// l the stretch, a the branch's viscous stretch; C_v = diag(a^2, 1/a, 1/a), so that this is the energy
/// G/2 (C_v^-1 : C - 3) with dC_v/dt = (C - (C : C_v^-1) C_v / 3) / tau of the physical formulation's viscosity.
struct MaxwellElement {
  IncompressibleLaw law;                // parallel to the branches
  std::vector<ViscousBranch> branches;  // moduli G [MPa] and relaxation times tau [s]
};

/// What is imposed over time: a stretch [-] or a nominal stress [MPa], linear between the times. Before the first time
/// nothing pulls and everything is relaxed: a first value that is not that of rest is a sudden step.
struct History {
  Eigen::VectorXd time_s;  // ascending
  Eigen::VectorXd value;   // as many
};

/// A branch of 1 MPa at each time of a history of stretches.
struct UnitBranch {
  Eigen::VectorXd stress;       // nominal [-]
  Eigen::VectorXd by_log_time;  // its derivative by ln(relaxation time)
};

/// Steps are halved until a step of order four agrees with one of order three within the tolerance, in ln(a). Before
/// that, a step is exact for small strains that are held or change evenly, however long over the relaxation time.
///
/// stretches  all > 0
/// source     the closed form of Shutov, Landgraf, Ihlemann, CMAME 265 (2013): C_v becomes the unimodular part of
///            w C_v + (1 - w) C, here with w = exp(-h / tau) and C between the step's ends; extrapolated
[[nodiscard]] UnitBranch unit_branch(const History& stretches, double time_s, double tolerance = 1e-8);

/// Nominal stress [MPa] under a history of stretches.
[[nodiscard]] Eigen::VectorXd stress_under(const MaxwellElement& element, const History& stretches);

/// Derivatives of the law's nominal stress at a stretch by whatever numbers it is made of.
using LawSlopes = std::function<Eigen::VectorXd(double stretch)>;

/// What a history of stresses leads to.
struct LoadedStretch {
  Eigen::VectorXd stretch;  // at each time [-]
  Eigen::MatrixXd slopes;   // its derivatives: by the numbers of the law, then by modulus and ln(time) of each branch
};

/// Under a history of nominal stresses [MPa]: the same steps, in which the stretch at the end balances the stress.
/// None where no stretch is found that does.
///
/// law_slopes  none: no derivatives are made
[[nodiscard]] std::optional<LoadedStretch> stretch_under(const MaxwellElement& element, const History& stresses,
                                                         const LawSlopes& law_slopes = {}, double tolerance = 1e-7);

}  // namespace softkin::calibration
