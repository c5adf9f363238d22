#pragma once

#include <array>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// Nodes of a quadratic tetrahedron: the corners, then those on its edges in the order of tetrahedron_edges [mm].
using TetrahedronNodes = Eigen::Matrix<double, 10, 3>;
using TetrahedronWeights = Eigen::Matrix<double, 10, 1>;
using Barycentric = Eigen::Vector4d;

[[nodiscard]] TetrahedronNodes nodes_of(const Points& vertices, const Tetrahedron& element,
                                        const EdgeNodes& edge_nodes);

/// Shape functions L_i (2 L_i - 1) of the corners and 4 L_i L_j of the edges at the barycentric coordinates L.
[[nodiscard]] TetrahedronWeights quadratic_shape(const Barycentric& l);
/// Their derivatives with respect to the four coordinates.
[[nodiscard]] Eigen::Matrix<double, 10, 4> quadratic_slope(const Barycentric& l);

/// Integrals of the shape functions over the element, signed [mm^3]; their sum is its volume. Exact for curved edges:
/// the integrand is of degree 5 and so is the rule. Straight edges: -1/20 of the volume at a corner, 1/5 at an edge.
///
/// source  N. J. Walkington, Quadrature on simplices of arbitrary dimension, 2000: 14 points, degree 5
[[nodiscard]] TetrahedronWeights shape_integrals(const TetrahedronNodes& nodes);

/// The least determinant of d(position)/d(L_1, L_2, L_3) at the corners, the four points of the rule of degree 2 with
/// which the energy is integrated, and those of shape_integrals [mm^3]; 6 volumes where the edges are straight.
[[nodiscard]] double min_jacobian(const TetrahedronNodes& nodes);

/// A bound from below of that determinant over the whole element [mm^3]: it is a cubic polynomial, which lies between
/// the least and the largest of its 20 Bezier coefficients.
///
/// source  A. Johnen, J.-F. Remacle, C. Geuzaine, Geometrical validity of curvilinear finite elements, 2013
[[nodiscard]] double min_jacobian_bound(const TetrahedronNodes& nodes);

/// Nodes of a quadratic triangle: the corners, then those on its edges 01, 12, 20 [mm].
using TriangleNodes = Eigen::Matrix<double, 6, 3>;

/// A point of a quadrature rule on the triangle: shape functions and their derivatives with respect to the second and
/// third barycentric coordinate.
struct TrianglePoint {
  Eigen::Matrix<double, 6, 1> shape, along_u, along_v;
  double weight = 0;  // the weights of a rule sum to 1/2, the area of the reference triangle
};
[[nodiscard]] TrianglePoint triangle_point(double u, double v, double weight);

/// Of six points, exact for polynomials of degree 4.
///
/// source  D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle, 1985
[[nodiscard]] const std::array<TrianglePoint, 6>& triangle_rule();

/// Integrals of the shape functions over a curved triangle [mm^2]; their sum is its area. Exact where it is flat with
/// straight edges: 0 at the corners and a third of the area at each edge.
[[nodiscard]] Eigen::Matrix<double, 6, 1> shape_integrals(const TriangleNodes& nodes);

}  // namespace softkin
