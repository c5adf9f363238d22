#pragma once

#include <functional>
#include <optional>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

namespace softkin {

/// The contact forces on a body in a shape.
struct Pressed {
  double normal_N = 0;               // sum of the magnitudes of all normal forces
  std::optional<double> slipping{};  // fraction of it in slipping contacts [-]; none: no friction or no contact
};

/// body    index into model.bodies
/// throws  InvalidInput on a body that the model does not have
[[nodiscard]] Pressed pressed(const Model& model, Index body, const ElementDeformation& shape);

/// Receives the current operation ("closing, step 2", "releasing 'cube'", "pulling along x, 2.5 N held") and its
/// progress; returning false stops it.
using GraspProgress = std::function<bool(const std::string& doing, const Progress& progress)>;

/// Receives each completed stage of a grasp ("closing, step 2", "releasing 'cube'") with its equilibrium.
using GraspStage = std::function<void(const std::string& done, const Equilibrium& shape)>;

/// The result of closing a gripper around its bodies and then releasing one of them.
struct Grasp {
  bool held = false;   // is there an equilibrium of the released body, no farther away than the body is long?
  std::string remark;  // what was not found and why, where not held
  Equilibrium last;    // the grasp, where held; else the last equilibrium
};

/// Closes a gripper while its bodies are held, each step from the last one, beginning at rest; then releases one of
/// them.
///
/// closing  actuations, at least one
/// body     index into model.bodies
/// returns  a grasp; it is not held where a step has no equilibrium or the body falls, also where it lands on something
/// throws   InvalidInput as pulled() and Statics::solve do, and without a step
[[nodiscard]] Grasp close_around(const Statics& statics, const std::vector<Actuation>& closing, Index body,
                                 const StaticsOptions& options = {}, const GraspProgress& progress = {},
                                 const GraspStage& stage = {});

/// A direction of a pull, and its name.
struct PullDirection {
  std::string name;     // "x"
  Vec3 along{0, 0, 0};  // its direction; of length 1 where it is used for a pull
};

/// A pull test: the body, the direction and the maximum force.
struct PullTask {
  Index body = -1;                // of model.bodies
  PullDirection direction;        // of any length > 0
  std::optional<double> max_N{};  // > 0: no larger force is tried; none: max_pull()
};

/// x, -x, y, -y, z, -z.
[[nodiscard]] std::vector<PullDirection> axes_to_pull_along();

/// The result of a pull test: the largest force that a grasp holds.
struct Pull {
  PullDirection direction;                // of length 1
  Status status = Status::not_converged;  // limit: it was found; converged: it exceeds the maximum; interrupted
  bool slips = false;                     // at the limit: is its friction used up
  double force_N = 0;                     // the largest at which there is an equilibrium
  double moved_mm = 0;                    // the center of mass of the body from where it was without the pull
  Pressed pressed;                        // the body, at that force
  Equilibrium last;                       // at that force
};

/// Returns the outcome: "slips", "gives way" (yields without slipping), "holds more" (than was tried), or the status
/// with which it ended.
[[nodiscard]] const char* what_then(const Pull& pull);

/// The actuation with a body released and pulled.
///
/// body       index into model.bodies
/// direction  of length 1
/// throws     InvalidInput on a body that the model does not have
[[nodiscard]] Actuation pulled(const Model& model, Actuation actuation, Index body, const Vec3& direction,
                               double force_N);

/// Finds the largest force on a body along a direction before it slips or no equilibrium exists, to a relative accuracy
/// of 1e-3. The force begins at a tenth of the body's weight, or of the normal contact force if that is larger. Its
/// steps double until one fails, and shrink after a failure. Failed steps cost most, as a body that nothing holds flies
/// off: a step is ended where the body moves far, or where 25 iterations make no progress.
///
/// grasp   an equilibrium that solve() returned, the body free
/// throws  InvalidInput as above, on a direction without length, a largest force that is not > 0, and as Statics::solve
///         does
[[nodiscard]] Pull largest_pull(const Statics& statics, const State& grasp, const PullTask& task,
                                const StaticsOptions& options = {}, const GraspProgress& progress = {});

/// Returns the largest pull on a body that the ranges of its commands along the axes allow [N].
[[nodiscard]] double max_pull(const Model& model, Index body);

}  // namespace softkin
