#pragma once

#include <softkin/linear/anderson.hpp>
#include <softkin/statics/statics.hpp>
#include <softkin/statics/supports/global_step.hpp>
#include <softkin/statics/target_shape/system.hpp>

namespace softkin::target_shape {

/// Algorithm 1, iteration by iteration, with optional Anderson acceleration. Accelerated steps that raise the energy
/// too much are rejected.
class LocalGlobal {
 public:
  /// anderson: earlier steps that are combined; 0: as printed. Puts positions where supports hold them.
  LocalGlobal(const System& system, const supports::GlobalStep& global, int anderson, const Actuation& actuation,
              Points& positions);

  /// One iteration from the current positions.
  ///
  /// record   its energy, gradient norm and step
  /// returns  false where a number is not finite: positions are the last good ones then, and the iteration is over
  [[nodiscard]] bool iterate(System::Scratch& scratch, Team& team, IterationRecord& record);

  /// Continues from an extrapolation of the last iterations.
  void extrapolate();

  /// Shapes before and after the last iteration.
  [[nodiscard]] const Points& before() const { return before_; }
  [[nodiscard]] const Points& positions() const { return positions_; }

 private:
  const System& system_;
  const supports::GlobalStep& global_;
  int anderson_;
  linear::Anderson mixer_;
  Actuation actuation_;
  Points& positions_;
  Points before_, accepted_;
  std::vector<supports::Pose> poses_;
  double tolerated_;  // energy beyond which an extrapolation is taken back [mm^5]
};

/// Enters an iteration into a report.
void accept(const IterationRecord& record, bool keep_history, SolveReport& report);

/// The objects with which Algorithm 1 works; they must outlive it.
struct Steps {
  const Model& model;
  const System& system;                // the local step
  const supports::GlobalStep& global;  // the global step
};

/// When iterations without progress end.
struct Patience {
  int iterations = 0;     // over which progress is measured
  double max_left = 0;    // maximum iterations left, at that rate
  bool descends = false;  // continue where the energy still falls
};

/// Algorithm 1 from result.state.positions until no vertex moves farther than report.tolerance_mm in an iteration, or
/// to PublishedStop. Fills state.positions and the report, its seconds aside.
///
/// source  Fang et al. 2020, Alg. 1, Eqs. (9)-(10)
void solve_local_global(const Steps& steps, const StaticsOptions& options, const Patience& patience,
                        const ProgressCallback& progress, Team& team, Equilibrium& result);

}  // namespace softkin::target_shape
