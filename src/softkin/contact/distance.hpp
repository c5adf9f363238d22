#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <softkin/core/types.hpp>

namespace softkin::contact {

/// A point a column [mm]: a vertex and the three corners of a triangle, or the two ends of one edge and those of
/// another. Lengths from 1e-30 to 1e30, or 0; triangles and edges may be degenerate.
using FourPoints = Eigen::Matrix<double, 3, 4>;
using Gradient = Eigen::Matrix<double, 12, 1>;  // three numbers a point
using Hessian = Eigen::Matrix<double, 12, 12>;
using Relief = Eigen::Matrix<double, 12, 2>;

/// A weight that is free to move: what `plus` gains of it `minus` loses.
struct FreeWeight {
  Vec3 along;  // x_plus - x_minus [mm]
  std::uint8_t plus = 0, minus = 0;
};

/// The shortest vector between two features: s = sum_i c_i x_i, with the minimum of d^2 = s . s over the free weights.
struct Separation {
  double squared;           // d^2 [mm^2]
  Eigen::Vector4d weights;  // c: of the vertex 1, of the corners -b_i <= 0; of the edges 1 - a, a, -(1 - b), -b
  Vec3 vector;              // s [mm]
  int free;                 // 0: point to point, 1: point to line, 2: point to plane or line to line
  std::array<FreeWeight, 2> moves;
  std::uint8_t nodes;  // bit i: point i takes part; the weight of the others is 0 and stays so
};

/// Column 0 is the vertex, 1 to 3 are the triangle.
[[nodiscard]] Separation vertex_triangle(const FourPoints& x);

/// The same to one side of the triangle alone: side k lies between its corners k and k + 1.
[[nodiscard]] Separation vertex_side(const FourPoints& x, int side);

/// The same to corner k alone.
[[nodiscard]] Separation vertex_corner(const FourPoints& x, int corner);

/// Columns 0 and 1 are one edge, 2 and 3 the other.
[[nodiscard]] Separation edge_edge(const FourPoints& x);

/// Of d^2 in the points [mm]: 2 c_i s; the free weights add nothing, as d^2 is least in them.
[[nodiscard]] Gradient squared_gradient(const Separation& separation);

/// By what the answer of the free weights lowers the Hessian of d^2, which is 2 (c c^T (x) I - Z Z^T): the columns of Z
/// [1]; 0 from column `free` on.
///
/// equation  of free weights p with orthonormal e_k = ds/dp_k: z_k = dc/dp_k (x) s + c (x) e_k
[[nodiscard]] Relief relief(const Separation& separation);

/// Of d^2 [1], exact as long as the same weights are free; jumps where that changes.
void squared_hessian(const Separation& separation, Hessian& out);

/// Of the mollifier of two edges: 1e-3 |e1|^2 |e2|^2 at rest [mm^4].
[[nodiscard]] double mollifier_threshold(const FourPoints& rest);

/// What multiplies the potential of two edges, so that it stays smooth where they become parallel and the closest
/// points jump: m = q (2 - q) for q = |e1 x e2|^2 / threshold < 1, otherwise 1.
///
/// source  Li et al. 2020, "Incremental potential contact", equation 24
[[nodiscard]] double mollifier(const FourPoints& x, double threshold);

/// The same with its derivatives in the points [1/mm, 1/mm^2].
double mollifier(const FourPoints& x, double threshold, Gradient& gradient, Hessian& hessian);

}  // namespace softkin::contact
