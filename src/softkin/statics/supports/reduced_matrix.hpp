#pragma once

#include <Eigen/SparseCore>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/statics/supports/freedoms.hpp>

namespace softkin::supports {

/// Which nodes a pattern over vertices couples, lower triangle. node_of: per vertex; -1: none
[[nodiscard]] Eigen::SparseMatrix<double> node_graph(const linear::BlockPattern& pattern,
                                                     const std::vector<Index>& node_of, Index nodes);

/// Second derivatives over the unknowns: how those of a pattern over vertices come into it. Its nodes stand in an order
/// of elimination of its own, which is that of the unknowns for the pattern of which these were made.
class ReducedMatrix {
 public:
  /// freedoms must outlive the object. pattern: that of which the freedoms were made
  ReducedMatrix(const Freedoms& freedoms, const linear::BlockPattern& pattern);

  /// Of a pattern that couples more: what is eliminated first stays so, as far as it can.
  [[nodiscard]] static ReducedMatrix wider(const Freedoms& freedoms, const linear::BlockPattern& pattern);

  [[nodiscard]] const linear::BlockColumns& columns() const { return columns_; }
  /// Is a node of the columns a scalar (see Freedoms), and how many are.
  [[nodiscard]] bool is_scalar(Index node) const {
    return vertex_at_[node] >= 0 && freedoms_->is_scalar(vertex_at_[node]);
  }
  [[nodiscard]] Index scalars() const { return freedoms_->scalars_.size(); }

  /// The second derivative in the unknowns of an energy with the given gradient and Hessian in x: T^T H T and, for
  /// turns, the contribution of the gradient. values: of columns(). The Hessian is given by the slots of the pattern.
  void reduce(const linear::BlockPattern& pattern, const LargeVector<double>& slots, const Points& gradient,
              const Points& positions, LargeVector<double>& values, Team& team) const;

  /// Do the unknowns stand in the order of the columns?
  [[nodiscard]] bool in_order() const { return unknown_at_.empty(); }
  /// From the order of the unknowns to that of the columns, and back.
  void to_columns(const Eigen::Ref<const Eigen::MatrixXd>& unknowns, Eigen::MatrixXd& out) const;
  void to_unknowns(const Eigen::MatrixXd& columns, Eigen::Ref<Eigen::MatrixXd> out) const;

 private:
  struct RegionBlock {  // a block of the matrix over vertices of which one or both are of a rigid region
    std::int64_t block, entry;
    Index row, column;  // vertices
    bool transposed;    // the entry's row node is the column's
  };

  ReducedMatrix(const Freedoms& freedoms, const linear::BlockPattern& pattern, const Eigen::SparseMatrix<double>& graph,
                const std::vector<Index>& order, const std::vector<Index>& pieces);
  void reduce_vertices(const LargeVector<double>& slots, LargeVector<double>& values, Team& team) const;
  void add_regions(const linear::BlockPattern& pattern, const LargeVector<double>& slots, const Points& positions,
                   LargeVector<double>& values) const;
  void add_turning(const Points& gradient, const Points& positions, LargeVector<double>& values) const;
  void find_sources(const linear::BlockPattern& pattern, const std::vector<Index>& place);

  const Freedoms* freedoms_;
  linear::BlockColumns columns_;
  std::vector<Index> vertex_at_, region_nodes_;  // per node of the columns: its vertex, -1: a region; of each region
  std::vector<Index> unknown_at_;                // per unknown of the columns; empty: all stand in order
  // per entry of columns_, in the order in which the matrix is written: its slots, 2 each, plus 1 where it is the
  // transpose
  std::vector<std::int64_t> source_starts_, sources_;  // none: of a region
  std::vector<RegionBlock> region_blocks_;
};

}  // namespace softkin::supports
