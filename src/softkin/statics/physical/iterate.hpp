#pragma once

#include <softkin/model/equilibrium.hpp>

namespace softkin::physical {

/// What is asked of a robot in the physical formulation.
struct Demand {
  Eigen::VectorXd actuation;  // m, as the user commands it
  double share = 1;           // of dead loads, dipoles, prestretch and displacements of supports [-]
  double fading = 0;          // share of what was not in balance where the way began [-]
};

/// At a share of the way from one to another.
[[nodiscard]] Demand between(const Demand& from, const Demand& to, double share);

/// Shape and multipliers; a point of the path that Newton follows.
struct Iterate {
  Points positions;               // #V by 3 [mm]
  Eigen::VectorXd multipliers;    // m: tension [N], gauge pressure [MPa], voltage of a dea [kV]
  std::vector<Anchor> anchors{};  // of friction
  std::vector<double> eyelets{};  // of tendons that rub, see Tendons; empty: they do not yet
};

/// How an equilibrium changes with the commands: what a derivative found.
struct Slopes {
  Points at;                           // no rows: not known
  std::vector<Index> held;             // the constraints that were
  Eigen::MatrixXd moves, multipliers;  // of the unknowns, of the constraints, per unit of each command
  Eigen::VectorXd foreseen_for{};      // an actuation whose equilibrium was foreseen from here; empty: none
  Iterate foreseen{};
};

}  // namespace softkin::physical
