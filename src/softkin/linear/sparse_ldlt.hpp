#pragma once

#include <Eigen/Core>
#include <memory>
#include <softkin/core/large_vector.hpp>
#include <softkin/linear/front_kernel.hpp>
#include <softkin/linear/front_tree.hpp>

namespace softkin::linear {

/// LDL^T of a symmetric sparse matrix without pivoting, multifrontal: analysed once, factorised many times, also by
/// several objects that share the analysis. Memory for L is taken at the first factorisation. The number of negative
/// pivots is the number of negative eigenvalues. Independent subtrees and large fronts run on the team; the result does
/// not depend on its size.
class SparseLdlt {
 public:
  explicit SparseLdlt(const BlockColumns& pattern);
  explicit SparseLdlt(std::shared_ptr<const FrontTree> tree);

  struct Pivots {
    Index negative = 0;  // as many as the matrix has negative eigenvalues
    Index replaced = 0;  // pivots too small to divide by; they count as negative
  };

  /// values: as the pattern's offsets say. least: magnitude below which a pivot is replaced.
  Pivots factorise(const LargeVector<double>& values, double least, Team& team);

  /// Every column of right_sides, in the pattern's order of unknowns, becomes its solution.
  void solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team);

  [[nodiscard]] Index size() const { return tree_->pattern.size(); }
  [[nodiscard]] std::int64_t nonzeros() const { return tree_->values; }
  [[nodiscard]] double flops() const { return tree_->flops; }
  [[nodiscard]] double bytes() const;

 private:
  struct Piece {
    FrontWork work;
    LargeVector<double> arena;  // fronts that wait for their parents
    Eigen::MatrixXd above;
    Eigen::VectorXd rows;  // of a solve: what goes to the top, what a front has below
    Index negative = 0;
  };

  void take_memory();
  void factor(Index front, const LargeVector<double>& values, double least, Piece& piece, Team& team);
  void assemble(Index index, const LargeVector<double>& values, double* front, const Piece& piece, Team& team) const;
  [[nodiscard]] Index top_front() const { return tree_->pieces[tree_->pieces.size() - 2]; }
  using Vector = Eigen::VectorXd;
  using Columns = Eigen::MatrixXd;
  void forward(const Front& front, Columns& x, Columns& above, Vector& work, Index top) const;
  void backward(const Front& front, Columns& x, Vector& work) const;

  std::shared_ptr<const FrontTree> tree_;
  LargeVector<double> lower_;
  std::vector<double> diagonal_;
  std::vector<Piece> pieces_;  // the top's is the last
  Columns solution_;
};

}  // namespace softkin::linear
