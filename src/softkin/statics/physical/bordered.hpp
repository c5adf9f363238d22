#pragma once

#include <softkin/linear/krylov.hpp>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

/// A column per right-hand side.
struct Columns {
  Eigen::MatrixXd moves, multipliers;  // of the unknowns, of the active measures
};

/// The equations K X + P L = right.moves, G^T X - C L = right.multipliers of one shape, with the stiffness K, the
/// gradients G of the measures, their compliances C, and the forces P per unit of the multipliers; P is G if no tendon
/// has friction. They are solved by a Krylov method with the factor in the workspace, which is of a nearby shape or of
/// a lower precision.
class Bordered {
 public:
  /// All must outlive the object.
  Bordered(const System& system, Workspace& work, Team& team)
      : system_(system), work_(work), saddle_(work.saddle), team_(team) {}

  /// Sets the equations of the last factorisation.
  void set_factorised(const Iterate& at);

  /// Sets the shape to an iterate, with the balance of its evaluation. The measures must be those of the last
  /// factorisation, or of couple(); the stiffness is the one gathered last.
  void set(const Iterate& at, const Balance& balance);

  /// accuracy  residual of each column over the right-hand side, both preconditioned by the factor
  /// rounds    maximum number of iterations
  /// guess     approximate solution; null: none
  /// returns   the relative residual; 1 or more if the constraints depend on each other or a number is not finite
  linear::Remainder solve(const Columns& right, double accuracy, int rounds, Columns& found,
                          const Columns* guess = nullptr);

  /// Computes the step of a balance as Saddle::step() does, from zero; change: of all multipliers.
  linear::Remainder step(const Balance& balance, double accuracy, int rounds, Eigen::VectorXd& step,
                         Eigen::VectorXd& change);

 private:
  linear::Remainder solve_block(const Columns& right, double accuracy, int rounds, Columns& found,
                                const Columns* guess);
  [[nodiscard]] Eigen::VectorXd weights_of(const Columns& about, const Columns& right) const;
  void precondition(Columns& columns);
  void multiply(const Columns& columns, Columns& product);
  [[nodiscard]] const Eigen::MatrixXd& pulls() const { return pulls_.cols() > 0 ? pulls_ : slopes_; }

  const System& system_;
  Workspace& work_;
  Saddle& saddle_;
  Team& team_;
  const Iterate* at_ = nullptr;
  Eigen::MatrixXd slopes_, pulls_;  // G; P if it differs
  Eigen::VectorXd compliance_;      // C; no rows: 0
};

}  // namespace softkin::physical
