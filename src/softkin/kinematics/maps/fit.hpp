#pragma once

#include <softkin/kinematics/maps/polynomials.hpp>

namespace softkin::maps {

/// What is known at a point.
struct Observation {
  Eigen::VectorXd x;       // d values from -1 to 1
  Eigen::VectorXd values;  // p, each over the accuracy that is wanted of it
  RowMatrix slopes;        // d by p, by x; no rows: not known
};

/// The sums of the terms that fit the observations best, values and slopes, in least squares. Slopes count as those by
/// the angle whose cosine x is, over the highest degree: as much as the values do. Terms of which too little is known
/// are kept small, those of high degree most.
///
/// decay  d values: by how much the logarithm of coefficients falls per degree
[[nodiscard]] Polynomials fit(const Terms& terms, const std::vector<Observation>& observations,
                              const Eigen::VectorXd& decay);

/// How fast coefficients fall per degree of each variable: the slope of the logarithm of the largest of that degree and
/// all above, until these do not fall any more: the rest is what is not known, and more such terms would tell less.
[[nodiscard]] Eigen::VectorXd decay_of(const Polynomials& polynomials);

/// Points of the box at which terms are known worst if observations at some points, values and slopes, are made: one
/// after the other, each as if those before were made too. Chosen among points that lie as dense as the zeros of
/// Chebyshev polynomials, the corners and the middles of faces; the same on every machine.
///
/// known    #points by d
/// returns  count by d
[[nodiscard]] RowMatrix worst_known(const Terms& terms, const Eigen::VectorXd& decay, const RowMatrix& known,
                                    Index count);

}  // namespace softkin::maps
