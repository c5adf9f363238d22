#pragma once

#include <Eigen/SparseCore>
#include <softkin/core/team.hpp>
#include <softkin/linear/kernels/front.hpp>
#include <softkin/linear/kernels/supernode.hpp>
#include <vector>

namespace softkin::linear {

struct Front;

/// Cholesky factor of a symmetric positive definite matrix, made once and solved many times, the three coordinates
/// together. Columns with (nearly) the same rows form supernodes, solved as dense blocks; independent subtrees of the
/// elimination tree are solved on several threads, and the result does not depend on their number.
class SparseFactor {
 public:
  /// matrix  the lower triangle is read
  /// order   of elimination, every row once; empty: one is sought (METIS)
  /// throws  InvalidInput where the matrix is not positive definite
  explicit SparseFactor(const Eigen::SparseMatrix<double>& matrix, const std::vector<Index>& order = {});

  /// right_side, n x 3, becomes the solution.
  void solve(Points& right_side, Team& team) const;

  [[nodiscard]] Index size() const { return order_.size(); }
  /// Entries of L, zeros that fill supernodes up included.
  [[nodiscard]] std::int64_t nonzeros() const { return static_cast<std::int64_t>(values_.size()) + size(); }

 private:
  /// Columns [begin, end) of L: below the diagonal, row by row, then its rows further down, `width` values each.
  struct Supernode {
    Index begin, end;
    std::int64_t first_row;  // in rows_
    Index inner_rows;        // rows before the top
    Index row_count;
    std::int64_t first_value;

    [[nodiscard]] Index width() const { return end - begin; }
    [[nodiscard]] std::int64_t first_below() const {
      return first_value + static_cast<std::int64_t>(width()) * (width() - 1) / 2;
    }
  };

  void add_supernode(const Front& front, const FrontColumns<double>& lower);
  [[nodiscard]] SupernodeColumns columns_of(const Supernode& node) const;

  std::vector<Index> order_;
  std::vector<Index> piece_nodes_;  // first supernode of every piece, then that of the top
  Index top_ = 0;                   // first row of the top
  std::vector<Supernode> nodes_;
  std::vector<Index> rows_;
  std::vector<double> values_, inverse_diagonal_;
};

}  // namespace softkin::linear
