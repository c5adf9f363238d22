#pragma once

#include <Eigen/Core>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/linear/ordering.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/supports/rigid_body.hpp>

namespace softkin::supports {

/// The degrees of freedom of a robot [mm]: free axes of its vertices, up to three slides and three turns of every rigid
/// region that is not held whole, turns by how far they move its farthest vertex (in rad their stiffness would differ
/// from that of moves by a length squared). x moves by T u to first order.
class Freedoms {
 public:
  /// scalars: the corners of the model's last vertices, if these are scalar unknowns, such as pressures: each belongs
  ///          to a corner, couples with the vertices around it, and has little or nothing on the diagonal
  Freedoms(const Model& model, const linear::BlockPattern& pattern, std::vector<Index> scalars = {});
  /// The same unknowns of a model with the same supports at other places.
  Freedoms(const Freedoms& like, const Model& model);

  [[nodiscard]] Index size() const { return unknowns_.back(); }

  /// Vertices that are not of a rigid region, in the order of elimination.
  [[nodiscard]] std::vector<Index> vertex_order() const;

  /// Unknowns that are scalars.
  [[nodiscard]] const std::vector<Index>& scalar_unknowns() const { return scalar_unknowns_; }

  /// T^T vectors. positions: where the rigid regions are
  void reduce(const Points& vectors, const Points& positions, Eigen::Ref<Eigen::VectorXd> out) const;

  /// The largest force of T^T vectors on a vertex, or on a rigid region, whose torque counts over its radius.
  [[nodiscard]] double largest(const Eigen::VectorXd& reduced) const;

  /// T u
  void expand(const Eigen::Ref<const Eigen::VectorXd>& unknowns, const Points& positions, Points& out) const;

  /// Moves positions by scale u: rigid regions turn, all else is x + scale T u.
  void move(const Eigen::Ref<const Eigen::VectorXd>& unknowns, double scale, Points& positions) const;

  /// Largest and root mean square move of a vertex [mm] that unknowns stand for, whatever scalars do.
  struct Size {
    double largest = 0, mean = 0;
  };
  [[nodiscard]] Size size_of(const Eigen::Ref<const Eigen::VectorXd>& unknowns, const Points& positions) const;

  /// Adds the contribution of the gradient to the second derivative by turns, times unknowns.
  void add_turning(const Points& gradient, const Points& positions, const Eigen::Ref<const Eigen::VectorXd>& unknowns,
                   Eigen::Ref<Eigen::VectorXd> out) const;

  /// Moves fixed vertices to rest + load_factor (held - rest), and rigid regions into their best-fit poses.
  void hold(double load_factor, Points& positions) const;

 private:
  friend class ReducedMatrix;
  struct Region : RigidBody {
    std::vector<int> slide_axes, turn_axes;
    Index node = -1;
    double reach = 1;  // of its vertices from its center [mm]
  };

  [[nodiscard]] static Mat3 bend_of(const Region& region, const Points& gradient, const Points& positions);
  void find_regions(const Model& model);
  [[nodiscard]] std::vector<std::array<Index, 2>> ends_of(const Model& model) const;
  void number(const Model& model, const linear::BlockPattern& pattern);
  [[nodiscard]] linear::Ordering ordering_of(const Model& model, const Eigen::SparseMatrix<double>& graph) const;
  [[nodiscard]] bool is_scalar(Index vertex) const { return vertex >= rest_.rows() - std::ssize(scalars_); }
  [[nodiscard]] Index nodes() const { return vertex_of_.size(); }
  [[nodiscard]] Index width(Index node) const { return unknowns_[node + 1] - unknowns_[node]; }
  [[nodiscard]] Eigen::Matrix<double, 3, Eigen::Dynamic> tangent(Index vertex, const std::vector<Vec3>& centers,
                                                                 const Points& positions) const;
  [[nodiscard]] std::vector<Vec3> centers(const Points& positions) const;

  Points rest_, held_;
  std::vector<std::array<bool, 3>> fixed_;  // per vertex and axis; regions aside
  std::vector<Index> scalars_, scalar_unknowns_;
  std::vector<Region> regions_;
  std::vector<Index> region_of_;  // per vertex, -1
  // nodes, which are free vertices and regions, in an order of elimination of the pattern
  std::vector<Index> pieces_;         // of that order
  std::vector<Index> vertex_of_;      // per node; -1: a region
  std::vector<Index> node_of_;        // per vertex, -1: none
  std::vector<Index> unknowns_{0};    // first of each node, then their number
  std::vector<Index> first_unknown_;  // per vertex, -1: none of its own
};

}  // namespace softkin::supports
