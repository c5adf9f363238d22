#pragma once

#include <functional>
#include <softkin/kinematics/estimate/fit.hpp>

namespace softkin::estimate {

/// By how many standard deviations a chi-square is larger than its freedoms, of the normal distribution that
/// (chi^2 / n)^(1/3) nearly has; 0 where there are no freedoms.
///
/// source  Wilson, Hilferty 1931, The distribution of chi-square
[[nodiscard]] double excess(double chi_square, double freedoms);

/// Fits readings of some weights: from the last estimate, or anew.
using Refit = std::function<Fit(const Eigen::VectorXd& weights, bool anew)>;

/// What a search anew may come to, from a linear fit: a cost.
using Forecast = std::function<double(const Eigen::VectorXd& weights)>;

/// Where readings contradict each other: leaves out the group without which the others agree best, or the two groups.
/// Where that does not make them agree either nothing is left out: then the model is wrong, not a reading.
///
/// all      the fit to all readings
/// tracked  was it one from the last estimate on?
/// weights  those of what is left out become 0
/// out      what is left out
[[nodiscard]] Fit without_outliers(const std::vector<ReadingGroup>& groups, const Eigen::VectorXd& values,
                                   Eigen::VectorXd& weights, Fit all, bool tracked, const Refit& refit,
                                   const Forecast& forecast, std::vector<std::size_t>& out);

}  // namespace softkin::estimate
