#pragma once

#include <softkin/model/mesh/boundary.hpp>

#include "model/block_mesh.hpp"
#include "model/round_mesh.hpp"

namespace softkin::testing {

/// Draws round bodies of a few coarse elements: rods, tubes and shells, thick and thin, bent, tapered, twisted,
/// elliptic; cubes pushed onto balls, whose corners are flat elements with two faces on the surface. Vertices slide
/// about on their surface.
class RandomRound {
 public:
  explicit RandomRound(unsigned seed) : random_(seed) {}

  /// A mesh whose elements do not overlap.
  Mesh draw() {
    while (true) {
      Mesh mesh = one();
      double sum = 0, least = HUGE_VAL;
      for (const Tetrahedron& t : mesh.tetrahedra) {
        const double volume = std::abs(signed_volume(mesh.vertices, t)), edge = longest_edge(mesh.vertices, t);
        sum += volume;
        least = std::min(least, volume / (edge * edge * edge));
      }
      const double enclosed = enclosed_volume(mesh.vertices, boundary_of(mesh.tetrahedra, {}).triangles);
      if (std::abs(sum - std::abs(enclosed)) < 1e-9 * sum && least > 1e-5) return mesh;
    }
  }

 private:
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  Mesh one() {
    switch (whole(0, 3)) {
      case 0:
        return rod(0);
      case 1:
        return rod(std::pow(10, real(-0.6, -0.01)));  // from 0.25 to 0.98
      case 2:
        return shell();
      default:
        return pushed_cube();
    }
  }

  Mesh rod(double hole) {
    const int corners = whole(6, 14), layers = whole(2, 6);
    const double length = real(1, 6), taper = real(-0.7, 0.7), bend = real(0, 4), twist = real(-1, 1);
    const double flat = real(0.6, 1), slide = real(0, 0.3);
    return layered(disc(corners, whole(1, 2), hole), layers, [&](const Vec3& p, double along) {
      const bool end = along == 0 || along == 1;
      const double s = end ? along : along + slide * real(-1, 1) / layers;
      const double turn = twist * s + slide * real(-1, 1) * std::numbers::pi / corners, radius = 1 + taper * (s - 0.5);
      const double y = radius * (std::cos(turn) * p.x() - std::sin(turn) * p.y());
      const double z = radius * flat * (std::sin(turn) * p.x() + std::cos(turn) * p.y());
      const double angle = bend * s, about = bend > 0.3 ? std::max(length / bend, 2.0) : 0;
      if (about == 0) return Vec3(length * s, y, z);
      return Vec3((about + y) * std::sin(angle), (about + y) * std::cos(angle) - about, z);
    });
  }

  Mesh shell() {
    const double inner = real(0.3, 0.98), slide = real(0, 0.15);
    const Vec3 axes(real(0.6, 1), real(0.6, 1), real(0.6, 1));
    Footprint surface = ball_surface(whole(0, 2));
    for (Index v = 0; v < surface.vertices.rows(); ++v)
      surface.vertices.row(v) =
          (surface.vertices.row(v) + slide * Eigen::RowVector3d(real(-1, 1), real(-1, 1), real(-1, 1))).normalized();
    return layered(surface, whole(1, 2), [&](const Vec3& p, double across) {
      return Vec3((inner + across * (1 - inner)) * axes.cwiseProduct(p));
    });
  }

  Mesh pushed_cube() {
    const int cells = whole(1, 4);
    Mesh mesh = block_mesh({cells, cells, cells}, Vec3::Constant(2), whole(0, 1) == 0 ? Split::six : Split::five);
    const bool ball = whole(0, 1) == 0;
    const Vec3 axes(real(0.5, 1), real(0.5, 1), real(0.5, 1));
    for (Index v = 0; v < mesh.vertices.rows(); ++v) {
      Vec3 p = mesh.vertices.row(v).transpose() - Vec3::Ones();
      Vec3 across = p;
      if (!ball) across[0] = 0;  // a rod along x
      if (across.norm() > 0) p += across * (across.cwiseAbs().maxCoeff() / across.norm() - 1);
      mesh.vertices.row(v) = axes.cwiseProduct(p).transpose();
    }
    for (Tetrahedron& t : mesh.tetrahedra)
      if (signed_volume(mesh.vertices, t) < 0) std::swap(t[2], t[3]);
    return mesh;
  }

  std::mt19937 random_;
};

}  // namespace softkin::testing
