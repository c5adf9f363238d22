#pragma once

#include <softkin/kinematics/estimate/variables.hpp>

namespace softkin::estimate {

/// What earlier readings tell: how likely they make unknowns, exp(-(y^T S y - 2 h^T y) / 2).
///
/// y are the numbers, and of each force of unknown place the products of its components with the place's coordinates,
/// less what they are before any reading in the mean and in units in which they are uncorrelated then, each of
/// deviation 1. Readings are about linear in them however far a place is told wrongly, as they are not in the force and
/// its place: what is known of these is a bent ridge of all pairs that do the same.
class Memory {
 public:
  /// Of nothing. variables must outlive the object.
  explicit Memory(const Variables& variables);

  /// y
  [[nodiscard]] Eigen::VectorXd at(const Eigen::VectorXd& values, const std::vector<Place>& places) const;
  /// Its derivative by Variables' columns.
  [[nodiscard]] Eigen::MatrixXd slopes(const Eigen::VectorXd& values, const std::vector<Place>& places) const;
  [[nodiscard]] const Eigen::MatrixXd& information() const { return information_; }  // S
  [[nodiscard]] const Eigen::VectorXd& pull() const { return pull_; }                // h

  /// Adds readings near unknowns.
  ///
  /// by_parts  readings by Variables::parts() at a base
  /// missed    what was computed under the unknowns less what was read; where the weight is 0 it is not looked at
  /// weights   1 / deviation^2; 0: not read
  void add(const Eigen::MatrixXd& by_parts, const std::vector<Place>& base, const Eigen::VectorXd& values,
           const std::vector<Place>& places, const Eigen::VectorXd& missed, const Eigen::VectorXd& weights);
  /// After a time in which what was told may have changed: y decays and is stirred so that without readings it comes to
  /// be known as before any, with this share of it left.
  ///
  /// share   exp(-elapsed / fade), 0 <= share <= 1
  /// source  Ornstein-Uhlenbeck process: mean a m, covariance a^2 P + (1 - a^2) I
  void fade(double share);
  void forget();

 private:
  /// Numbers and products.
  [[nodiscard]] Eigen::VectorXd sums(const Eigen::VectorXd& values, const std::vector<Place>& places) const;

  const Variables& variables_;
  Eigen::MatrixXd from_y_, to_y_;  // sums less their mean by y, and back
  Eigen::VectorXd mean_;           // of the sums
  Eigen::MatrixXd information_;
  Eigen::VectorXd pull_;
};

}  // namespace softkin::estimate
