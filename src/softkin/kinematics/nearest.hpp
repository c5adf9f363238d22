#pragma once

#include <memory>
#include <softkin/kinematics/goal.hpp>
#include <softkin/model/equilibrium.hpp>

namespace softkin {

/// Finds points near a point, in any dimension.
class NearestPoints {
 public:
  /// A point a row.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// throws  InvalidInput on no rows, no columns, or a number that is not finite
  explicit NearestPoints(Rows points);
  ~NearestPoints();
  NearestPoints(NearestPoints&&) noexcept;
  NearestPoints& operator=(NearestPoints&&) noexcept;

  struct Found {
    Index row = 0;
    double distance = 0;
  };
  /// Returns the nearest points, nearest first, at most `count`.
  ///
  /// throws  InvalidInput on a target of another dimension or one that is not finite, or count < 1
  [[nodiscard]] std::vector<Found> find(const Eigen::VectorXd& target, Index count = 1) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Finds the samples of a workspace at which goals are nearest to being met.
class NearestSamples {
 public:
  /// samples  of the model; those without an equilibrium are left out
  /// throws   InvalidInput as check_goals does, where no sample is left, or where a sample has other markers
  NearestSamples(const Model& model, std::vector<WorkspaceSample> samples);

  /// Returns the samples with the smallest weighted sum of the goals' squared errors, best first, at most `count`.
  ///
  /// returns  indices into samples(); for positions alone by a k-d tree, made once for each set of markers and axes
  [[nodiscard]] std::vector<Index> find(const std::vector<Goal>& goals, Index count = 1);

  [[nodiscard]] const std::vector<WorkspaceSample>& samples() const { return samples_; }

 private:
  const Model& model_;
  std::vector<WorkspaceSample> samples_;
  std::vector<double> scales_;  // what the tree is of: marker by axis, 0: left out
  std::unique_ptr<NearestPoints> tree_;
};

}  // namespace softkin
