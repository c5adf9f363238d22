#pragma once

#include <softkin/linear/krylov.hpp>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

/// A column per right-hand side.
struct Columns {
  Eigen::MatrixXd moves, multipliers;  // of the unknowns, of the active measures
};

/// K X + P L = right.moves, G^T X - C L = right.multipliers with the stiffness K, the slopes G, their compliances C and
/// what multipliers pull with, P, of one shape; P is G where no tendon rubs. Solved by Krylov's method with the factor
/// that the workspace has, of a shape nearby, or of a lower precision.
class Bordered {
 public:
  /// All must outlive the object.
  Bordered(const System& system, Workspace& work, Team& team)
      : system_(system), work_(work), saddle_(work.saddle), team_(team) {}

  /// The equations of the last factorisation themselves.
  void set_factorised(const Iterate& at);

  /// The shape, at an iterate, with the balance of its evaluation. The measures must be those of the last
  /// factorisation, or of couple(); the stiffness is that which was gathered last.
  void set(const Iterate& at, const Balance& balance);

  /// accuracy  of each column, over the right-hand side, both as the factor answers
  /// rounds    at most
  /// guess     nearly the solution; null: none is known
  /// returns   what is left; 1 or more where the constraints depend on each other or a number is not finite
  linear::Remainder solve(const Columns& right, double accuracy, int rounds, Columns& found,
                          const Columns* guess = nullptr);

  /// The step of a balance, as Saddle::step() says, from zero; change: of all multipliers.
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
  Eigen::MatrixXd slopes_, pulls_;  // G; P where it is another
  Eigen::VectorXd compliance_;      // C; no rows: 0
};

}  // namespace softkin::physical
