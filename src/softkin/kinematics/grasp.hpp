#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// How far a body can be pulled out of what holds it.
struct Pull {
  Vec3 direction{0, 0, 0};                // of length 1
  Status status = Status::not_converged;  // limit: it was found; converged: more than was asked; interrupted
  double force_N = 0;                     // the largest at which there is an equilibrium
  double moved_mm = 0;                    // the center of mass of the body from where it was without the pull
  Equilibrium last;                       // at that force
};

/// The actuation with a body released and pulled.
///
/// body       index into model.bodies
/// direction  of length 1
/// throws     InvalidInput on a body that the model does not have
[[nodiscard]] Actuation pulled(const Model& model, Actuation actuation, Index body, const Vec3& direction,
                               double force_N);

/// The largest force on a body along a direction before it slips or no equilibrium is left: the pull grows fourfold
/// from the body's weight, or from what presses on it if that is more, until an equilibrium cannot be followed.
///
/// grasp    an equilibrium that solve() returned, the body free
/// most_N   > 0: no larger force is tried
/// throws   InvalidInput as above, on a direction without length, and as Statics::solve does
[[nodiscard]] Pull largest_pull(const Model& model, const Statics& statics, const State& grasp, Index body,
                                const Vec3& direction, double most_N, const StaticsOptions& options = {},
                                const ProgressCallback& progress = {});

/// Of the commands along the axes, the largest that a body may be pulled with [N].
[[nodiscard]] double most_pull(const Model& model, Index body);

}  // namespace softkin
