#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A command for each actuator of a model, in its order: ratio [-], tension [N], gauge pressure [kPa], or as
/// command_unit() has it.
using Actuation = Eigen::VectorXd;

/// The point of another part's surface to which a vertex sticks or from which it slips: friction acts towards it.
struct Anchor {
  Index vertex = -1, part = -1;  // the vertex by its place among those of ContactModel's triangles, ascending
  Index triangle = -1;           // of ContactModel, of that part
  Vec3 weights = Vec3::Zero();   // of its corners; their sum is 1
  double slipped_mm = 0;         // slip distance since the contact began [mm]
};

/// The state of the Maxwell elements of a body: bar C and every branch's C_v at the quadrature points, in the order of
/// Statics.
struct ViscousHistory {
  std::vector<double> strains;  // six entries each: xx, yy, zz, xy, yz, xz [-]; determinant 1
};

/// The result of the Maxwell elements after a time step.
struct ViscousFlow {
  std::shared_ptr<const ViscousHistory> history{};  // at its end
  double lost_mJ = 0;                               // energy that they dissipate at the shape at its end, >= 0
};

/// The state at which a search begins or has ended.
struct State {
  Points positions;               // #V by 3 [mm]
  Actuation actuation{};          // of which positions is an equilibrium; empty: not known
  Eigen::VectorXd multipliers{};  // m: tension [N], gauge pressure [kPa], voltage [kV], else 0; empty: not known
  double load_factor = 1;         // of dead loads, prestretch, moved supports; -1: of no known equilibrium [-]
  std::vector<Anchor> anchors{};  // of friction, sorted by vertex, then part; empty: no friction yet
  std::vector<double> eyelets{};  // cables with friction: lengths beyond each turn at which it has none [mm]
  Eigen::VectorXd pressures{};    // of mixed elements, in the order of Statics; tension is positive; empty: computed
                                  // from the positions, which determine them [MPa]
  std::shared_ptr<const ViscousHistory> history{};             // viscous: at the beginning of the time step
  double elapsed_s = std::numeric_limits<double>::infinity();  // since then; 0: instant, infinity: relaxed

  /// Does it contain the actuation, of this number of values, of which positions is an equilibrium?
  [[nodiscard]] bool knows(Eigen::Index actuators) const { return actuation.size() == actuators && load_factor >= 0; }
};

/// limit: the path of equilibria ends before the requested actuation; the shape is the last good one.
enum class Status { converged, not_converged, interrupted, limit };

/// Energies are in mm^5, gradients in mm^4 (target-shape; mm^3 and mm^2 of mesh-independent weights), or in mJ and N
/// (physical).
struct IterationRecord {
  double energy = 0;         // before the step
  double step_mm = 0;        // largest move of a vertex [mm]
  double gradient_norm = 0;  // Euclidean norm of the residual before the step
};

/// An attempted step of the path to an equilibrium.
struct TracedStep {
  double from = 0, to = 0;  // fraction of the requested path [-]
  double length = 0;        // of the current path segment, where gravity may precede the loads [-]
  std::string along{};      // "": of the path; else the chamber or cable whose volume or length controls the step
  double predicted_mm = 0;  // largest move of a vertex to the predicted shape
  double corrected_mm = 0;  // and from there to the equilibrium; 0: there was none
  int iterations = 0, factorisations = 0, factorisations_in_double = 0, projections = 0,
      shifts = 0;      // how many the step took, as SolveReport counts them
  bool taken = false;  // did it lead to an equilibrium from which the path continued
  std::string why{};   // it was not taken; or the kind of the equilibrium
};

/// Equilibria along the volume or length of an actuator whose load was requested and has a limit point, in their order.
struct LoadBranch {
  /// An equilibrium on it.
  struct Point {
    double measure = 0;  // over that at rest [-]
    double load = 0;     // gauge pressure [kPa] or tension [N]
  };
  Index actuator = -1;          // none
  std::vector<Point> points{};  // of the actuator, in their order along it
};

/// The report of the physical formulation on a solve, in addition to SolveReport.
struct PhysicalReport {
  double residual_N = 0;       // the largest residual force at a vertex or on a rigid region [N]
  double pull_N = 0;           // the largest sum of element forces at a vertex [N], with which it is compared
  int unstable_modes = 0;      // number of unstable modes of the equilibrium
  int buckled = 0;             // how often an unstable equilibrium was left for a stable one
  double buckled_mm = 0;       // the largest displacement of a vertex in these [mm]
  double snapped_mm = 0;       // the largest deviation of a step from its tangent prediction [mm]; 0: no snap-through
  double snapped_from = 0;     // fraction of the path at which that step began [-]
  double friction_change = 0;  // of a vertex' friction in the last update of normal forces, over the largest [-]
  double unstable_from = 0;    // the first fraction of the path at which a passed equilibrium was unstable [-]
  LoadBranch branch;           // where a limit point was traced
};

/// How a solve ended, and what it took.
struct SolveReport {
  Status status = Status::not_converged;  // of the result
  bool stopped = false;                   // by its progress callback or its deadline
  std::string solver;                     // name of the method that found it: "newton", "local-global"
  int iterations = 0;                     // number of iterations, in all steps of the path
  int factorisations = 0;                 // of the stiffness; newton
  int factorisations_in_double = 0;       // of them, as single precision was not enough; physical
  int projections = 0;                    // iterations in which element Hessians were made positive semidefinite
  int shifts = 0;                         // iterations in which a multiple of the diagonal was added
  int continuation_steps = 0;             // equilibria on the path, the last one included; newton
  double reached = 1;                     // fraction of the path from the start's actuation to the requested one [-]
  std::string remark;                     // why it stopped, where status is not converged; or how it is unstable
  double energy = 0;                      // at the last shape evaluated
  double step_mm = 0;                     // last step [mm]
  double tolerance_mm = 0;                // step at which the iteration stops [mm]; NaN: of a map, see answered()
  double gradient_norm = 0;               // at the last shape evaluated: norm of the residual, as in IterationRecord
  PhysicalReport physical;                // of the physical formulation; else as initialised
  double estimated_error_mm = 0;          // distance from the fixed point that the small step may hide [mm]
  std::vector<IterationRecord> history;   // of every iteration; empty without StaticsOptions::keep_history
  std::vector<TracedStep> trace;          // with StaticsOptions::trace
  double seconds = 0;                     // that the solve took [s]

  /// Was the equilibrium evaluated by a map, without iterations?
  [[nodiscard]] bool answered() const { return std::isnan(tolerance_mm); }
};

/// The result of a solve: the shape, the requested actuation, and the report.
struct Equilibrium {
  State state;          // the shape and its loads; the last good one where it is not converged
  Actuation actuation;  // m: requested
  SolveReport report;   // how it was found
};

/// One stored equilibrium of a sampled workspace.
struct WorkspaceSample {
  Index number = 0;               // of the sample in its workspace, from 0
  Actuation actuation;            // m, as requested
  Points markers{};               // #markers by 3 [mm]; of the last good shape where status is limit; else no rows
  Eigen::VectorXd multipliers{};  // m: tension [N] or gauge pressure [kPa]; empty where there are no markers
  Status status = Status::not_converged;  // how its solve ended
  double reached = 0;                     // fraction of the path from rest to the actuation at the markers [-]
  int iterations = 0;                     // that its solve took
};

}  // namespace softkin
