#pragma once

#include <optional>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

/// Adds the first-order change of shape and multipliers from one load state to another, with the current factorisation.
///
/// returns  the largest move of a vertex [mm]
double predict(const System& system, const LoadState& here, const LoadState& there, const std::vector<bool>& active,
               Workspace& work, Team& team, Iterate& at);

/// Returns the first-order change of shape alone, without the correction for rotations: #V by 3 [mm].
[[nodiscard]] Points first_order_moves(const System& system, const LoadState& here, const LoadState& there,
                                       const std::vector<bool>& active, Workspace& work, Team& team, const Iterate& at);

struct ClearPrediction {
  Points predicted, straight;     // by predict(); without the correction for rotations
  std::optional<double> move_mm;  // largest move of a vertex, without collision; none where a shorter step is better:
                                  // supports collide, or little of a long motion is left
  bool cut = false;               // does a collision shorten the motion
};
/// Predicts as predict() does, but ends the motion before surfaces would pass through each other.
ClearPrediction predict_clear(const System& system, const LoadState& here, const LoadState& there,
                              const std::vector<bool>& active, Workspace& work, Team& team, Iterate& at);

/// Moves the supports to their places at the target state, with the body following as if nothing else changed. Returns
/// false if a collision blocks the motion, or the stiffness is singular.
bool carry_held(const System& system, const LoadState& here, const LoadState& there, const std::vector<bool>& active,
                Workspace& work, Team& team, Iterate& at);

/// Extrapolates the equilibrium under other commands to second order, from the derivative computed at the shape: the
/// residual along the tangent is corrected with the current factorisation. The workspace stores the result.
///
/// returns  false where no derivative is stored, contact is possible, or the law has no energy there
/// source   as geodesic acceleration, Transtrum and Sethna 2012
bool extrapolate(const System& system, const LoadState& here, const LoadState& there, Workspace& work, Team& team,
                 const Iterate& at, Points& positions);

/// Moves `at` to the equilibrium stored by extrapolate(), and from there along the tangent. Returns false if none is
/// stored for `at`.
bool follow_extrapolated(const System& system, const LoadState& here, const LoadState& there,
                         const std::vector<bool>& active, Workspace& work, Team& team, Iterate& at);

/// Moves `at` to the caller's initial guess for the load state `there`. Returns false if there is none.
bool follow_initial_guess(const LoadState& here, const LoadState& there, Workspace& work, Iterate& at);

/// Predicts the equilibria around a given one by its stiffness.
class Predictor {
 public:
  /// at: the given equilibrium, with its actuation and multipliers
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
