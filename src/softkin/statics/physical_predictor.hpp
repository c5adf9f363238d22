#pragma once

#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical_system.hpp>

namespace softkin {

/// First-order change of shape and multipliers from one demand to another, with the factor at hand.
///
/// returns  the largest move of a vertex [mm]
double predict(const PhysicalSystem& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
               PhysicalSystem::Workspace& work, Team& team, Iterate& at);

/// The stiffness at an equilibrium, for predictions of those around it.
class PhysicalPredictor {
 public:
  /// at: of a known actuation, with multipliers.
  PhysicalPredictor(const PhysicalSystem& system, PhysicalSystem::Workspace& work, const State& at, Team& team);

  [[nodiscard]] State predict(const Actuation& actuation, Team& team);

 private:
  const PhysicalSystem& system_;
  PhysicalSystem::Workspace& work_;
  State at_;
  Iterate iterate_;
  std::vector<bool> active_;
};

}  // namespace softkin
