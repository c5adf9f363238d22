#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <softkin/core/large_vector.hpp>
#include <softkin/linear/front_kernel.hpp>
#include <softkin/linear/front_tree.hpp>
#include <softkin/linear/kernels/front.hpp>

namespace softkin::linear {

struct Pivots {
  Index negative = 0;  // as many as the matrix has negative eigenvalues
  Index replaced = 0;  // too small to divide by; they count as negative
};

/// LDL^T of a symmetric sparse matrix without pivoting, multifrontal: analysed once, factorised many times, also by
/// several objects with a common analysis. Memory for L is taken at the first factorisation. The number of negative
/// pivots is the number of negative eigenvalues, where rounding leaves it. Independent subtrees and large fronts run on
/// the team; the result does not depend on its size.
///
/// Number  double, or float: half the memory and twice the rate; right-hand sides and sums of solves stay in double
template <class Number>
class SparseLdltOf {
 public:
  explicit SparseLdltOf(const BlockColumns& pattern);
  explicit SparseLdltOf(std::shared_ptr<const FrontTree> tree);

  /// Goes on with another pattern, in the memory that there is; nothing is factorised.
  void change(std::shared_ptr<const FrontTree> tree);

  /// values  as the pattern's offsets say
  /// least   magnitude below which a pivot is replaced
  /// spare   memory to work in instead of the object's own: what stands in it is lost, and it may grow
  Pivots factorise(const LargeVector<double>& values, double least, Team& team, LargeVector<double>* spare = nullptr);

  /// Every column of right_sides, in the pattern's order of unknowns, becomes its solution.
  void solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team);

  /// A front's columns of L.
  [[nodiscard]] FrontColumns<Number> lower(Index front) const;
  [[nodiscard]] const std::vector<Number>& diagonal() const { return diagonal_; }

  [[nodiscard]] Index size() const { return tree_->pattern.size(); }
  [[nodiscard]] std::int64_t nonzeros() const { return tree_->values; }
  [[nodiscard]] double flops() const { return tree_->flops; }
  [[nodiscard]] double bytes() const;

 private:
  /// What one thread writes while it factorises pieces, one after the other: small enough for its cache.
  struct Bench {
    FrontWork<Number> work;
    Number* arena = nullptr;  // fronts that wait for their parents
    LargeVector<double> memory;
  };
  struct Piece {
    Eigen::MatrixXd above, rows;  // of a solve: what goes to the top, and columns of one front
    Index negative = 0;
  };
  class Seat;

  void take_memory();
  Index factor(Index front, const LargeVector<double>& values, Number least, Bench& bench, Team& team);
  [[nodiscard]] FrontPlace<Number> place_of(Index front, const Bench& bench);
  void assemble(Index index, const LargeVector<double>& values, Number* front, Team& team) const;
  void add_children(Index index, bool of_pivots, const FrontPlace<Number>& front, const Bench& bench, Team& team) const;
  [[nodiscard]] Index top_front() const { return tree_->pieces[tree_->pieces.size() - 2]; }
  void forward(Index front, Index begin, Index columns, Piece& piece, Index top);
  void backward(Index front, Index begin, Index columns, Piece& piece);

  std::shared_ptr<const FrontTree> tree_;
  bool has_memory_ = false;                // for this tree
  std::vector<RowPack> packs_;             // of the rows that each front leaves to its parent
  std::vector<std::int64_t> first_pack_;   // of each front, then their number
  LargeVector<Number> lower_;              // columns of L, front after front
  std::vector<std::int64_t> first_value_;  // of each front
  std::vector<Number> diagonal_;
  std::vector<Piece> pieces_;  // the top's is the last
  Bench top_;
  std::vector<std::unique_ptr<Bench>> benches_;  // of the other pieces; those that no thread sits at
  std::mutex benches_mutex_;
  Eigen::MatrixXd solution_;
};

extern template class SparseLdltOf<double>;
extern template class SparseLdltOf<float>;
using SparseLdlt = SparseLdltOf<double>;

}  // namespace softkin::linear
