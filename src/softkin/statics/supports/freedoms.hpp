#pragma once

#include <Eigen/Core>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/supports/rigid_body.hpp>

namespace softkin::supports {

/// The unknowns of a robot [mm]: the free axes of its vertices, and up to three slides and three turns of every rigid
/// region that is not held whole, turns by how far they move its farthest vertex (in rad their stiffness would differ
/// from that of moves by a length squared). x moves by T u to first order.
class Freedoms {
 public:
  Freedoms(const Model& model, const linear::BlockPattern& pattern);

  [[nodiscard]] Index size() const { return columns_.size(); }
  /// Pattern of the matrix over the unknowns, in the order of elimination, which is theirs.
  [[nodiscard]] const linear::BlockColumns& columns() const { return columns_; }

  /// Vertices that are not of a rigid region, in the order of elimination.
  [[nodiscard]] std::vector<Index> vertex_order() const;

  /// T^T vectors. positions: where the rigid regions are
  void reduce(const Points& vectors, const Points& positions, Eigen::Ref<Eigen::VectorXd> out) const;

  /// The largest force of T^T vectors on a vertex, or on a rigid region, whose torque counts over its radius.
  [[nodiscard]] double largest(const Eigen::VectorXd& reduced) const;

  /// T u
  void expand(const Eigen::Ref<const Eigen::VectorXd>& unknowns, const Points& positions, Points& out) const;

  /// Moves positions by scale u: rigid regions turn, all else is x + scale T u.
  void move(const Eigen::Ref<const Eigen::VectorXd>& unknowns, double scale, Points& positions) const;

  /// The second derivative in the unknowns of an energy with the given gradient and Hessian in x: T^T H T and, for
  /// turns, what the gradient adds. values: of columns(). The Hessian is given by the slots of the pattern.
  void reduce_matrix(const linear::BlockPattern& pattern, const LargeVector<double>& slots, const Points& gradient,
                     const Points& positions, LargeVector<double>& values, Team& team) const;

  /// Adds what the gradient adds for turns to that second derivative, times unknowns.
  void add_turning(const Points& gradient, const Points& positions, const Eigen::Ref<const Eigen::VectorXd>& unknowns,
                   Eigen::Ref<Eigen::VectorXd> out) const;

  /// Puts what is fixed at rest + share (held - rest), and rigid regions into the pose that fits them best.
  void hold(double share, Points& positions) const;

 private:
  struct Region : RigidBody {
    std::vector<int> slide_axes, turn_axes;
    Index node = -1;
    double reach = 1;  // of its vertices from its center [mm]
  };
  struct RegionBlock {  // a block of the matrix over vertices of which one or both are of a rigid region
    std::int64_t block, entry;
    Index row, column;  // vertices
    bool transposed;    // the entry's row node is the column's
  };

  [[nodiscard]] static Mat3 bend_of(const Region& region, const Points& gradient, const Points& positions);
  void find_regions(const Model& model);
  void number(const linear::BlockPattern& pattern);
  void find_sources(const linear::BlockPattern& pattern, const std::vector<Index>& node_of);
  [[nodiscard]] Eigen::Matrix<double, 3, Eigen::Dynamic> tangent(Index vertex, const std::vector<Vec3>& centers,
                                                                 const Points& positions) const;
  [[nodiscard]] std::vector<Vec3> centers(const Points& positions) const;

  Points rest_, held_;
  std::vector<std::array<bool, 3>> fixed_;  // per vertex and axis; regions aside
  std::vector<Region> regions_;
  std::vector<Index> region_of_;      // per vertex, -1
  std::vector<Index> vertex_of_;      // per node in elimination order; -1: a region
  std::vector<Index> first_unknown_;  // per vertex, -1: none of its own
  linear::BlockColumns columns_;
  // per entry of columns_, in the order in which the matrix is written: its slots, 2 each, plus 1 where it is the
  // transpose
  std::vector<std::int64_t> source_starts_, sources_;  // none: of a region
  std::vector<RegionBlock> region_blocks_;
};

}  // namespace softkin::supports
