#pragma once

#include <softkin/linear/sparse_factor.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/supports/rigid_body.hpp>
#include <softkin/statics/supports/turning.hpp>

namespace softkin::supports {

/// Position and rotation of a rigid region: vertex v stands at center + rotation (rest_v - rest center).
struct Pose {
  Vec3 center;  // [mm]
  Mat3 rotation;
};

/// The global step of Algorithm 1, Eq. (10), with supports: fixed vertices and axes are left out of the system, rigid
/// regions move as one.
///
/// A rigid region's vertices are [1 q] H with the 4 x 3 matrix H = [center; R^T]. All other vertices are eliminated
/// with the constant factor, which leaves a small quadratic in the H of all regions; it is minimised over the poses by
/// Gauss-Newton. The step so minimises the energy at fixed targets exactly, rigid regions included.
class GlobalStep {
 public:
  /// matrix  lower triangle, one coordinate
  /// order   vertices in a good order of elimination, all that are free among them; empty: one is sought
  /// throws  InvalidInput where a part is not held
  GlobalStep(const Model& model, const Eigen::SparseMatrix<double>& matrix, const std::vector<Index>& order = {});

  /// Moves positions (#V by 3) by the step for residual (#V by 3); poses move along.
  void step(const Points& residual, Points& positions, std::vector<Pose>& poses, Team& team) const;

  /// Moves fixed vertices to their supports, turned by the actuation's angles, and rigid regions into their best-fit
  /// poses.
  [[nodiscard]] std::vector<Pose> project(const Eigen::VectorXd& actuation, Points& positions) const;

  /// Poses that fit best.
  [[nodiscard]] std::vector<Pose> poses(const Points& positions) const;

  /// Returns the residual without the forces of supports: fixed axes are zero, rigid regions keep net force and torque
  /// only, as the root of the sum of squares [unit of residual].
  [[nodiscard]] double free_norm(const Points& residual, const std::vector<Pose>& poses) const;

 private:
  using Handles = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // 4 rows per rigid region
  struct Group {                                             // axes with the same free vertices
    std::vector<int> axes;
    std::vector<Index> free;                   // vertices
    std::vector<linear::SparseFactor> factor;  // one; none where nothing is free
    Eigen::MatrixXd coupling;                  // A_fh, #free by 4 #regions
    Eigen::MatrixXd follow;                    // A_ff^-1 A_fh: how free vertices follow the handles
    Eigen::MatrixXd schur;                     // A_hh - A_hf A_ff^-1 A_fh
  };

  void add_regions(const Model& model);
  void make_group(const Eigen::SparseMatrix<double>& matrix, const std::vector<Index>& order, Group& group);
  void place(const RigidBody& region, const Pose& pose, Points& positions) const;
  [[nodiscard]] Handles handles_of(const Points& residual) const;
  [[nodiscard]] Handles handles_of(const std::vector<Pose>& poses) const;
  [[nodiscard]] Eigen::MatrixXd tangent_of(const std::vector<Pose>& poses, int axis) const;
  [[nodiscard]] Eigen::VectorXd gauss_newton_move(const Handles& slope, const std::vector<Pose>& poses) const;
  void move_poses(const Handles& requested, std::vector<Pose>& poses) const;

  std::vector<Group> groups_;
  std::vector<RigidBody> regions_;
  std::vector<Index> region_of_;            // per vertex, -1
  std::vector<std::array<bool, 3>> fixed_;  // per vertex and axis, rigid regions aside
  Points rest_, held_;
  Turning turning_;
};

}  // namespace softkin::supports
