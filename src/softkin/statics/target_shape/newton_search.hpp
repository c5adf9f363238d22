#pragma once

#include <softkin/statics/target_shape/local_global.hpp>
#include <softkin/statics/target_shape/newton_tangent.hpp>

namespace softkin::target_shape {

/// What a search works in; it holds nothing that outlives a search but, for sensitivities, the last factor.
struct Workspace {
  explicit Workspace(const Unknowns& unknowns);

  Tangent tangent;
  System::Scratch local;  // of the last shape evaluated
  System::Scratch start;  // of the shape that a step starts from
  System::Scratch work;
  Points home;  // equilibrium near which the tangent was factorised; empty: none
};

/// Runs of Newton's method, one after another.
class NewtonSearch {
 public:
  /// exhausted: no more iterations are allowed. astray: a number is not finite.
  enum class End { converged, stuck, interrupted, exhausted, astray };

  /// All must outlive the object. The result does not depend on what the workspace was used for before.
  NewtonSearch(const Unknowns& unknowns, const supports::GlobalStep& global, Workspace& workspace,
               const StaticsOptions& options, const ProgressCallback& progress, Team& team, SolveReport& report);

  /// From positions to the equilibrium at an actuation; positions are the last shape.
  ///
  /// patience  local-global iterations that may be put in where Newton's method does not get on
  End run(const Actuation& actuation, int patience, Points& positions);

 private:
  enum class Step { full, shortened, none };

  void evaluate(const Actuation& actuation, Points& positions);
  void move(double scale, Points& positions);
  [[nodiscard]] Step newton_step(const Actuation& actuation, Points& positions);
  [[nodiscard]] bool exact_direction(const Points& positions);
  [[nodiscard]] bool projected_direction(const Points& positions);
  void take_back(const Actuation& actuation, Points& positions);
  [[nodiscard]] Step search_energy(const Actuation& actuation, Points& positions);
  [[nodiscard]] Step search_residual(const Actuation& actuation, Points& positions);
  [[nodiscard]] bool close(const Actuation& actuation, Points& positions, double& step_mm);
  [[nodiscard]] bool negligible(int halvings, const Points& positions) const;
  [[nodiscard]] double natural_norm(const Points& positions);
  End local_global(const Actuation& actuation, int count, Points& positions);
  [[nodiscard]] End enter(const IterationRecord& record);
  [[nodiscard]] IterationRecord here() const;

  const Unknowns& unknowns_;
  const supports::GlobalStep& global_;
  const StaticsOptions& options_;
  const ProgressCallback& progress_;
  Team& team_;
  SolveReport& report_;
  Tangent& tangent_;
  System::Scratch &local_, &start_, &work_;
  std::vector<supports::Pose> poses_, poses_before_;
  Points before_, moves_;
  Eigen::VectorXd residual_, step_, scaled_, natural_;
  double energy_ = 0, least_energy_ = 0, natural_start_ = 0, tolerance_ = 0;
  bool exact_ = false;           // is step_ that of the exact derivative
  bool projected_next_ = false;  // far from equilibria the exact derivative tells little
  bool keep_factor_ = false;     // the last one is still good
};

}  // namespace softkin::target_shape
