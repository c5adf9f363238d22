#pragma once

#include <softkin/model/equilibrium.hpp>

namespace softkin::physical {

/// The record of a solve while it runs: what it has cost, how far it is, and what happened on its path. The solver
/// decides by it; its report, an output, contains a copy of it at the end and is never read.
struct SolveRecord {
  int iterations = 0;                                 // these and the following as SolveReport has them
  int factorisations = 0;                             // of the stiffness
  int factorisations_in_double = 0;                   // of them, in double precision
  int projections = 0;                                // iterations with a projected stiffness
  int shifts = 0;                                     // factorisations with a shift
  int continuation_steps = 0;                         // equilibria on the path
  double reached = 0;                                 // fraction of the whole requested path
  double energy = 0, step_mm = 0, gradient_norm = 0;  // of the last iteration
  double friction_change = 0;                         // these and the following as PhysicalReport has them
  double snapped_mm = 0, snapped_from = 0;            // the longest snap-through
  double unstable_from = 0;                           // where the path became unstable; 0: nowhere
  int buckled = 0;                                    // number of unstable equilibria left
  double buckled_mm = 0;                              // by the longest of these displacements
  LoadBranch branch{};                                // traced by a measure
  std::vector<IterationRecord> history{};             // of every iteration, where requested

  /// Adds a step of Newton's method or of arc-length continuation.
  void note_iteration(const IterationRecord& iteration, bool keep) {
    ++iterations;
    energy = iteration.energy;
    step_mm = iteration.step_mm;
    gradient_norm = iteration.gradient_norm;
    if (keep) history.push_back(iteration);
  }
  /// Adds a factorisation of the stiffness, perhaps in double precision.
  void note_factorisation(bool in_double) {
    ++factorisations;
    factorisations_in_double += in_double ? 1 : 0;
  }
  /// Adds a snap-through, which is kept if it is the longest one.
  ///
  /// from  fraction of the whole requested path
  void note_snap(double move_mm, double from) {
    if (move_mm <= snapped_mm) return;
    snapped_mm = move_mm;
    snapped_from = from;
  }

  /// Copies the record to a report.
  void write_to(SolveReport& report) const {
    report.iterations = iterations;
    report.factorisations = factorisations;
    report.factorisations_in_double = factorisations_in_double;
    report.projections = projections;
    report.shifts = shifts;
    report.continuation_steps = continuation_steps;
    report.reached = reached;
    report.energy = energy;
    report.step_mm = step_mm;
    report.gradient_norm = gradient_norm;
    report.physical.friction_change = friction_change;
    report.physical.snapped_mm = snapped_mm;
    report.physical.snapped_from = snapped_from;
    report.physical.unstable_from = unstable_from;
    report.physical.buckled = buckled;
    report.physical.buckled_mm = buckled_mm;
    report.physical.branch = branch;
    report.history = history;
  }
};

}  // namespace softkin::physical
