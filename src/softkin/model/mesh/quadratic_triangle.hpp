#pragma once

#include <Eigen/Core>
#include <array>
#include <softkin/core/types.hpp>

namespace softkin {

/// Nodes of a quadratic triangle: the corners, then those on its edges 01, 12, 20 [mm].
using TriangleNodes = Eigen::Matrix<double, 6, 3>;

/// A point of the six-point rule on the triangle, exact for polynomials of degree 4: shape functions and their
/// derivatives with respect to the second and third barycentric coordinate.
struct TrianglePoint {
  Eigen::Matrix<double, 6, 1> shape, along_u, along_v;
  double weight = 0;  // the weights sum to 1/2, the area of the reference triangle
};

/// source  D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle, 1985
[[nodiscard]] const std::array<TrianglePoint, 6>& triangle_rule();

/// Integrals of the shape functions over a curved triangle [mm^2]; their sum is its area. Exact where it is flat with
/// straight edges: 0 at the corners and a third of the area at each edge.
[[nodiscard]] Eigen::Matrix<double, 6, 1> shape_integrals(const TriangleNodes& nodes);

}  // namespace softkin
