#pragma once

#include <functional>
#include <optional>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

namespace softkin {

/// What presses on a body in a shape.
struct Pressed {
  double normal_N = 0;               // sum of the magnitudes of all normal forces
  std::optional<double> slipping{};  // share of it where it slips [-]; none: no friction, or nothing presses
};

/// body    index into model.bodies
/// throws  InvalidInput on a body that the model does not have
[[nodiscard]] Pressed pressed(const Model& model, Index body, const ElementDeformation& shape);

/// Told what is being done ("closing, step 2", "releasing 'cube'", "pulling along x, 2.5 N held") and how far that is;
/// false stops.
using GraspProgress = std::function<bool(const std::string& doing, const Progress& progress)>;

/// Told of each stage of a grasp when it is done ("closing, step 2", "releasing 'cube'"), with its equilibrium.
using GraspStage = std::function<void(const std::string& done, const Equilibrium& shape)>;

/// A gripper that was closed around its bodies and has let go of one.
struct Grasp {
  bool held = false;   // is there an equilibrium without what held the body, no farther away than it is long?
  std::string remark;  // what was not found and why, where not held
  Equilibrium last;    // the grasp, where held; else as far as it came
};

/// Closes a gripper with its bodies held, each step from the last, beginning at rest; then releases one of them.
///
/// closing  actuations, at least one
/// body     index into model.bodies
/// returns  that a step has no equilibrium, or the body falls, be it onto something, is not held
/// throws   InvalidInput as pulled() and Statics::solve do, and without a step
[[nodiscard]] Grasp close_around(const Statics& statics, const std::vector<Actuation>& closing, Index body,
                                 const StaticsOptions& options = {}, const GraspProgress& progress = {},
                                 const GraspStage& stage = {});

/// A direction to pull in, and what it is called.
struct PullDirection {
  std::string name;     // "x"
  Vec3 along{0, 0, 0};  // its direction; of length 1 where it is pulled along
};

/// What is pulled at, and how.
struct PullTask {
  Index body = -1;                 // of model.bodies
  PullDirection direction;         // of any length > 0
  std::optional<double> most_N{};  // > 0: no larger force is tried; none: most_pull()
};

/// x, -x, y, -y, z, -z.
[[nodiscard]] std::vector<PullDirection> axes_to_pull_along();

/// How far a body can be pulled out of what holds it.
struct Pull {
  PullDirection direction;                // of length 1
  Status status = Status::not_converged;  // limit: it was found; converged: more than was asked; interrupted
  double force_N = 0;                     // the largest at which there is an equilibrium
  double moved_mm = 0;                    // the center of mass of the body from where it was without the pull
  Pressed pressed;                        // the body, at that force
  Equilibrium last;                       // at that force
};

/// "slips", "gives way" (otherwise than by slipping), "holds more" (than was tried), or the status that it ended by.
[[nodiscard]] const char* what_then(const Pull& pull);

/// The actuation with a body released and pulled.
///
/// body       index into model.bodies
/// direction  of length 1
/// throws     InvalidInput on a body that the model does not have
[[nodiscard]] Actuation pulled(const Model& model, Actuation actuation, Index body, const Vec3& direction,
                               double force_N);

/// The largest force on a body along a direction before it slips or no equilibrium is left, to 1e-3 of it. The pull is
/// followed from a tenth of the body's weight, or of what presses on it if that is more, in steps that double until one
/// is not met, and shrink where one is not. That costs most, as a body that nothing holds flies off: a step is left
/// where the body moves far, or where 25 iterations lead no farther.
///
/// grasp   an equilibrium that solve() returned, the body free
/// throws  InvalidInput as above, on a direction without length, a largest force that is not > 0, and as Statics::solve
///         does
[[nodiscard]] Pull largest_pull(const Statics& statics, const State& grasp, const PullTask& task,
                                const StaticsOptions& options = {}, const GraspProgress& progress = {});

/// Of the commands along the axes, the largest that a body may be pulled with [N].
[[nodiscard]] double most_pull(const Model& model, Index body);

}  // namespace softkin
