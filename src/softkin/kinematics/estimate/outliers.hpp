#pragma once

#include <functional>
#include <softkin/kinematics/estimate/fit.hpp>

namespace softkin::estimate {

/// By how many standard deviations a chi-square is larger than its freedoms, of the normal distribution that
/// (chi^2 / n)^(1/3) nearly has; 0 where there are no freedoms.
///
/// source  Wilson, Hilferty 1931, The distribution of chi-square
[[nodiscard]] double excess(double chi_square, double freedoms);

/// Fits to readings of some weights.
struct Fits {
  using ToWeights = std::function<Fit(const Eigen::VectorXd& weights)>;
  ToWeights anew;
  ToWeights tracked{};   // from the last estimate on; empty: there is none
  ToWeights foretold{};  // the same by its slopes, without an equilibrium
  /// From another fit, with what was known before that one.
  std::function<Fit(const Eigen::VectorXd& weights, const Fit& near, bool anew)> near;
  /// Have so many equilibria not been found that no further readings are to be left out?
  std::function<bool()> exhausted{};
  /// What a fit anew may come to, from a linear fit: a cost.
  std::function<double(const Eigen::VectorXd& weights)> forecast;
};

/// The fit to all readings where they agree; else to those without the group, or the two groups, without which the
/// others do and which they contradict. Where nothing makes them agree nothing is left out: then the model is wrong,
/// not a reading.
///
/// weights  those of what is left out become 0
/// out      groups that are left out, ascending
[[nodiscard]] Fit agreeing_fit(const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values,
                               Eigen::VectorXd& weights, const Fits& fits, std::vector<std::size_t>& out);

}  // namespace softkin::estimate
