#pragma once

#include <optional>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

/// First-order change of shape and multipliers from one demand to another, with the factor at hand.
///
/// returns  the largest move of a vertex [mm]
double predict(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
               Workspace& work, Team& team, Iterate& at);

/// The same change of shape to first order alone, without what turns add: #V by 3 [mm].
[[nodiscard]] Points first_order_moves(const System& system, const Demand& here, const Demand& there,
                                       const std::vector<bool>& active, Workspace& work, Team& team, const Iterate& at);

struct ClearPrediction {
  Points predicted, straight;     // as predict() gives it; without what turns add
  std::optional<double> move_mm;  // the largest of a vertex, as far as it is clear; none where a shorter way is better:
                                  // supports are in each other's way, or little of a long one is left
  bool cut = false;               // is it shorter than predicted
};
/// The same, less far where otherwise something would pass through something.
ClearPrediction predict_clear(const System& system, const Demand& here, const Demand& there,
                              const std::vector<bool>& active, Workspace& work, Team& team, Iterate& at);

/// Brings what is held to its place, and lets the body follow it as if nothing else changed. False where something is
/// in the way, or the stiffness has no step.
bool carry_held(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
                Workspace& work, Team& team, Iterate& at);

/// The equilibrium under other commands by second order, from the derivative that was asked for at the shape: what the
/// tangent leaves out of balance there, through the factor at hand. The workspace keeps it.
///
/// returns  false where no derivative is known, something may touch, or the law has no energy there
/// source   as geodesic acceleration, Transtrum and Sethna 2012
bool foresee(const System& system, const Demand& here, const Demand& there, Workspace& work, Team& team,
             const Iterate& at, Points& positions);

/// Moves `at` to where foresee() and the tangent lead. False where nothing was foreseen from there.
bool follow_foreseen(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
                     Workspace& work, Team& team, Iterate& at);

/// Moves `at` to where the caller foretold the equilibrium of a demand. False where nothing was.
bool follow_foretold(const Demand& here, const Demand& there, Workspace& work, Iterate& at);

/// The stiffness at an equilibrium, for predictions of those around it.
class Predictor {
 public:
  /// at: of a known actuation, with multipliers.
  Predictor(const System& system, Workspace& work, const State& at, Team& team);

  [[nodiscard]] State predict(const Actuation& actuation, Team& team);

 private:
  const System& system_;
  Workspace& work_;
  State at_;
  Iterate iterate_;
  std::vector<bool> active_;
};

}  // namespace softkin::physical
