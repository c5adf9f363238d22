#pragma once

#include <memory>
#include <optional>
#include <softkin/linear/sparse_ldlt.hpp>

namespace softkin::linear {

/// LDL^T in single precision where that is accurate enough, else in double. Single precision takes half the memory and
/// is nearly twice as fast.
///
/// Let A be the matrix and M the product of its factor. Where M is positive definite, A is as well if
/// x . (M - A) x < x . M x for every x; that is tested, with a large margin, on the solution x of M x = b for a b
/// without any symmetry, which M^-1 has turned towards the eigenvalues nearest 0: there rounding has most effect. Where
/// M is not definite or solutions have to be good, I - M^-1 A must contract there: then no matrix on the straight line
/// from M to A is singular, so that both have as many negative eigenvalues.
class MixedLdlt {
 public:
  explicit MixedLdlt(std::shared_ptr<const FrontTree> tree) : tree_(std::move(tree)) {}

  /// Changes to another pattern; nothing is factorised.
  void change(std::shared_ptr<const FrontTree> tree);

  /// As if nothing had been factorised before: results are then those of a new object.
  void forget();

  /// Reports that single precision was insufficient in spite of the test: the next factors are in double, as many as
  /// after a factor that fails the test.
  void distrust();

  /// The required accuracy of solutions, as of factorise() and solve(). sign: as enough, and a guess where the matrix
  /// seems not to be positive definite.
  enum class Precision { sign, enough, good, twice };

  /// Factorises, and solves for every column of right_sides, as solve() does.
  ///
  /// values     as the pattern's offsets say
  /// least      magnitude below which a pivot is replaced
  /// precision  sign, enough, good: in single precision where that does; twice: in double whatever single does
  /// spare      as SparseLdltOf::factorise() takes it
  /// throws     InvalidInput where double precision is called for and there is not the memory
  Pivots factorise(const LargeVector<double>& values, double least, Precision precision,
                   Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team, LargeVector<double>* spare = nullptr);

  /// Every column of right_sides, in the pattern's order of unknowns, becomes its solution: to rounding in double
  /// precision; in single it may miss half of what is along the eigenvalues nearest 0 (enough), or three tenths (good),
  /// and little beside that.
  void solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team);

  /// Is the last factor in double precision?
  [[nodiscard]] bool in_double() const { return in_double_; }
  /// Does it meet the requested precision? Where it does not, with `sign`, negative pivots and solutions are a guess.
  [[nodiscard]] bool trusted() const { return trusted_; }
  /// Fraction of x . M x that rounding has changed for the tested x; 0 in double precision.
  [[nodiscard]] double rounded() const { return in_double_ ? 0 : rounded_; }
  [[nodiscard]] double bytes() const;
  [[nodiscard]] double flops() const { return tree_->flops; }
  [[nodiscard]] std::int64_t nonzeros() const { return tree_->values; }

 private:
  bool solve_trusted(const LargeVector<double>& values, bool by_energy, const Eigen::MatrixXd& right_sides, Team& team);

  std::shared_ptr<const FrontTree> tree_;
  std::optional<SparseLdltOf<float>> single_;
  std::optional<SparseLdlt> twice_;
  bool in_double_ = false, trusted_ = true;
  double rounded_ = 0;
  int wait_ = 0,
      patience_ = 1;  // factorisations in double before single is tried again, now and after the next failure
  Eigen::VectorXd unsymmetric_;
  Eigen::MatrixXd found_, left_;
};

}  // namespace softkin::linear
