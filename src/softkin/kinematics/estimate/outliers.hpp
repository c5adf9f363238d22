#pragma once

#include <functional>
#include <softkin/kinematics/estimate/fit.hpp>

namespace softkin::estimate {

/// Returns by how many standard deviations a chi-square exceeds its degrees of freedom, by the nearly normal
/// distribution of (chi^2 / n)^(1/3); 0 where there are no degrees of freedom.
///
/// source  Wilson, Hilferty 1931, The distribution of chi-square
[[nodiscard]] double excess(double chi_square, double freedoms);

/// Functions that fit the unknowns to readings of given weights.
struct Fits {
  using ToWeights = std::function<Fit(const Eigen::VectorXd& weights)>;
  ToWeights anew;
  ToWeights tracked{};    // from the last estimate on; empty: there is none
  ToWeights predicted{};  // the same by its slopes, without an equilibrium
  /// From another fit, with the prior of that one.
  std::function<Fit(const Eigen::VectorXd& weights, const Fit& near, bool anew)> near;
  /// Have so many solves failed that no further readings are to be left out?
  std::function<bool()> exhausted{};
  /// The cost that a new fit may reach, estimated by a linear fit.
  std::function<double(const Eigen::VectorXd& weights)> forecast;
};

/// Returns the fit to all readings where they agree; else the fit without the one or two groups that contradict the
/// others, where the others agree. Where no such groups are found nothing is left out: then the model is wrong, not a
/// reading.
///
/// weights  those of readings that are left out become 0
/// out      groups that are left out, ascending
[[nodiscard]] Fit agreeing_fit(const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values,
                               Eigen::VectorXd& weights, const Fits& fits, std::vector<std::size_t>& out);

}  // namespace softkin::estimate
