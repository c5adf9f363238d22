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

/// Where a vertex sticks to a part of another surface, or slips from: friction pulls it there.
struct Anchor {
  Index vertex = -1, part = -1;  // the vertex by its place among those of ContactModel's triangles, ascending
  Index triangle = -1;           // of ContactModel, of that part
  Vec3 weights = Vec3::Zero();   // of its corners; their sum is 1
  double slipped_mm = 0;         // way that it slipped since it touches [mm]
};

/// What the Maxwell elements of a body remember: bar C and every branch's C_v at the quadrature points, as Statics
/// orders them.
struct ViscousHistory {
  std::vector<double> strains;  // six entries each: xx, yy, zz, xy, yz, xz [-]; determinant 1
};

/// What Maxwell elements do in a time step.
struct ViscousFlow {
  std::shared_ptr<const ViscousHistory> history{};  // at its end
  double lost_mJ = 0;                               // energy that they lose at the shape at its end, >= 0
};

/// Where a search begins or ended.
struct State {
  Points positions;               // #V by 3 [mm]
  Actuation actuation{};          // of which positions is an equilibrium; empty: not known
  Eigen::VectorXd multipliers{};  // m: tension [N], gauge pressure [kPa], voltage [kV], else 0; empty: not known
  double share = 1;  // of dead loads, prestretch and displacements of supports; -1: of no equilibrium that is known [-]
  std::vector<Anchor> anchors{};  // of friction, sorted by vertex, then part; empty: nothing rubs yet
  std::vector<double> eyelets{};  // cables that rub: lengths beyond where they turn, at which they would not [mm]
  Eigen::VectorXd pressures{};    // of mixed elements, as Statics orders them; tension is positive; empty: found from
                                  // the positions, which have but those [MPa]
  std::shared_ptr<const ViscousHistory> history{};             // viscous: at the beginning of the time step
  double elapsed_s = std::numeric_limits<double>::infinity();  // since then; 0: instant, infinity: relaxed

  /// Whether it tells of which actuation, of so many values, positions is an equilibrium.
  [[nodiscard]] bool knows(Eigen::Index actuators) const { return actuation.size() == actuators && share >= 0; }
};

/// limit: there is no equilibrium to be followed as far as was asked; the shape is the last good one.
enum class Status { converged, not_converged, interrupted, limit };

/// Energies are in mm^5, gradients in mm^4 (target-shape; mm^3 and mm^2 of mesh-independent weights), or in mJ and N
/// (physical).
struct IterationRecord {
  double energy = 0;         // before the step
  double step_mm = 0;        // largest move of a vertex [mm]
  double gradient_norm = 0;  // Euclidean norm of what is not in balance before the step
};

/// A step of the way to an equilibrium, as it was tried.
struct TracedStep {
  double from = 0, to = 0;  // share of the way that was asked for [-]
  double length = 0;        // of the way at hand, which weights may go before loads [-]
  std::string along{};      // "": of the way; else the chamber or cable along whose volume or length it goes
  double predicted_mm = 0;  // largest move of a vertex to the predicted shape
  double corrected_mm = 0;  // and from there to the equilibrium; 0: there was none
  int iterations = 0, factorisations = 0, factorisations_in_double = 0, projections = 0,
      shifts = 0;      // how many the step took, as SolveReport counts them
  bool taken = false;  // did it lead to an equilibrium that was gone on from
  std::string why{};   // it was not taken; or what the equilibrium is
};

/// Equilibria along the volume or length of an actuator whose load was asked for and has a maximum, in their order.
struct LoadBranch {
  /// An equilibrium on it.
  struct Point {
    double measure = 0;  // over that at rest [-]
    double load = 0;     // gauge pressure [kPa] or tension [N]
  };
  Index actuator = -1;          // none
  std::vector<Point> points{};  // of the actuator, in their order along it
};

/// What the physical formulation tells of how an equilibrium was found, beside SolveReport.
struct PhysicalReport {
  double residual_N = 0;       // the largest force out of balance at a vertex or on a rigid region [N]
  double pull_N = 0;           // the largest sum of what elements pull at a vertex [N], which it is compared with
  int unstable_modes = 0;      // ways in which the equilibrium is unstable
  int buckled = 0;             // how often an unstable equilibrium was left for a stable one
  double buckled_mm = 0;       // the largest move of a vertex thereby [mm]
  double snapped_mm = 0;       // the longest move that a step made beside what its tangent predicts [mm]; 0: none
  double snapped_from = 0;     // share of the way at which that step began [-]
  double friction_change = 0;  // of a vertex' friction when normal forces were found anew, over the largest [-]
  double unstable_from = 0;    // the first share of the way at which an equilibrium passed was unstable [-]
  LoadBranch branch;           // where a maximum was looked for
};

/// How a solve ended, and what it took.
struct SolveReport {
  Status status = Status::not_converged;  // of the result
  bool stopped = false;                   // before it had ended by itself: by its progress callback or its deadline
  std::string solver;                     // name of the method that found it: "newton", "local-global"
  int iterations = 0;                     // how many were done, all steps of the way together
  int factorisations = 0;                 // of the stiffness; newton
  int factorisations_in_double = 0;       // of them, as single precision was not enough; physical
  int projections = 0;                    // iterations in which element Hessians were made positive semidefinite
  int shifts = 0;                         // iterations in which a multiple of the diagonal was added
  int continuation_steps = 0;             // equilibria on the way, the last one included; newton
  double reached = 1;                     // share of the way from the start's actuation to the one asked for [-]
  std::string remark;                     // why it stopped, where status is not converged; or how it is unstable
  double energy = 0;                      // at the last shape evaluated
  double step_mm = 0;                     // last step [mm]
  double tolerance_mm = 0;                // step at which the iteration stops [mm]; NaN: a map answered, see answered()
  double gradient_norm = 0;       // at the last shape evaluated: norm of what is not in balance, as in IterationRecord
  PhysicalReport physical;        // else as it is begun
  double estimated_error_mm = 0;  // distance from the fixed point that the small step may hide [mm]
  std::vector<IterationRecord> history;  // of every iteration; empty without StaticsOptions::keep_history
  std::vector<TracedStep> trace;         // with StaticsOptions::trace
  double seconds = 0;                    // that the solve took [s]

  /// A map gave the equilibrium: there is nothing to tell of an iteration.
  [[nodiscard]] bool answered() const { return std::isnan(tolerance_mm); }
};

/// What a solve gives: the shape, what was asked for, and how it was found.
struct Equilibrium {
  State state;          // the shape and its loads; the last good one where it is not converged
  Actuation actuation;  // m: asked for
  SolveReport report;   // how it was found
};

/// What is kept of one equilibrium of a sampled workspace.
struct WorkspaceSample {
  Index number = 0;               // of the sample in its workspace, from 0
  Actuation actuation;            // m, as asked for
  Points markers{};               // #markers by 3 [mm]; of the last good shape where status is limit; else no rows
  Eigen::VectorXd multipliers{};  // m: tension [N] or gauge pressure [kPa]; empty where there are no markers
  Status status = Status::not_converged;  // how its solve ended
  double reached = 0;                     // share of the way from rest to the actuation at which the markers are [-]
  int iterations = 0;                     // that its solve took
};

}  // namespace softkin
