#pragma once

#include <softkin/kinematics/maps/polynomials.hpp>

namespace softkin::maps {

/// Values and slopes at a point.
struct Observation {
  Eigen::VectorXd x;       // d values from -1 to 1
  Eigen::VectorXd values;  // p, each over its requested accuracy
  RowMatrix slopes;        // d by p, by x; no rows: not known
};

/// Returns the sums of terms that fit the observations, values and slopes, in least squares. Slopes are taken by the
/// angle whose cosine is x, over the highest degree, so that their weight equals that of the values. Terms that the
/// observations do not determine are kept small by regularisation, most those of high degree.
///
/// decay  d values: by how much the logarithm of coefficients falls per degree
[[nodiscard]] Polynomials fit(const Terms& terms, const std::vector<Observation>& observations,
                              const Eigen::VectorXd& decay);

/// Returns how fast coefficients decay per degree of each variable: the slope of the logarithm of the largest
/// coefficient of that degree and all above, until these do not fall any more: the rest is below the error of the fit.
[[nodiscard]] Eigen::VectorXd decay_of(const Polynomials& polynomials);

/// Returns the points of the box with the largest variance of the terms, given observations of values and slopes at the
/// known points: one after the other, each as if those before were observed too. They are chosen among points with the
/// density of the zeros of Chebyshev polynomials, the corners and the middles of faces; the same on every machine.
///
/// known    #points by d
/// returns  count by d
[[nodiscard]] RowMatrix worst_known(const Terms& terms, const Eigen::VectorXd& decay, const RowMatrix& known,
                                    Index count);

}  // namespace softkin::maps
