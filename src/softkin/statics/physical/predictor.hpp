#pragma once

#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

/// First-order change of shape and multipliers from one demand to another, with the factor at hand.
///
/// returns  the largest move of a vertex [mm]
double predict(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
               System::Workspace& work, Team& team, Iterate& at);

/// The stiffness at an equilibrium, for predictions of those around it.
class Predictor {
 public:
  /// at: of a known actuation, with multipliers.
  Predictor(const System& system, System::Workspace& work, const State& at, Team& team);

  [[nodiscard]] State predict(const Actuation& actuation, Team& team);

 private:
  const System& system_;
  System::Workspace& work_;
  State at_;
  Iterate iterate_;
  std::vector<bool> active_;
};

}  // namespace softkin::physical
