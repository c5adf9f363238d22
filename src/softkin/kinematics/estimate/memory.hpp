#pragma once

#include <softkin/kinematics/estimate/variables.hpp>

namespace softkin::estimate {

/// The information of earlier readings: the likelihood that they give to unknowns, exp(-(y^T S y - 2 h^T y) / 2).
///
/// y contains the numbers, and for each force of unknown place the products of its components with the place's
/// coordinates. Their prior means are subtracted, and they are scaled so that they are uncorrelated with standard
/// deviation 1 before any reading. Readings are nearly linear in y however large the error of a place is. They are not
/// linear in the force and its place, whose likelihood is a curved ridge of all pairs with the same effect.
class Memory {
 public:
  /// Contains no information at first. variables must outlive the object.
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
  /// missed    computed values less readings at the unknowns; not used where the weight is 0
  /// weights   1 / deviation^2; 0: not read
  void add(const Eigen::MatrixXd& by_parts, const std::vector<Place>& base, const Eigen::VectorXd& values,
           const std::vector<Place>& places, const Eigen::VectorXd& missed, const Eigen::VectorXd& weights);
  /// Reduces the information after a time in which the unknowns may have changed: y decays under noise, so that without
  /// readings its distribution returns to the prior one; this fraction of y remains.
  ///
  /// fraction  exp(-elapsed / fade), 0 <= fraction <= 1
  /// source  Ornstein-Uhlenbeck process: mean a m, covariance a^2 P + (1 - a^2) I
  void fade(double fraction);
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
