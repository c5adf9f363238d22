#pragma once

#include <softkin/energy/contact_laws.hpp>

#include "statics/contact_scenes.hpp"

namespace softkin::testing {

/// Balls of radius 20 mm, E 1 MPa, nu 0.3, pressed on a rigid plane or on each other; a quarter of the half that
/// touches, of order 2 with curved faces. Its equator, a plane of symmetry of a ball between two plates, is moved.
struct PressedBalls {
  static constexpr double radius = 20, modulus = 1, poisson = 0.3;

  double approach = 0;  // by which undeformed surfaces would overlap [mm]
  double distance = 0;  // of contact [mm]
  double cell = 0.06;   // at the pole, over the radius
  bool two = false;     // ball on ball

  [[nodiscard]] double effective_modulus() const { return modulus / (1 - poisson * poisson) / (two ? 2 : 1); }
  [[nodiscard]] double effective_radius() const { return two ? radius / 2 : radius; }
  [[nodiscard]] double gap() const { return (two ? 2.5 : 0.5) * distance; }  // at rest

  [[nodiscard]] RobotSpec robot() const {
    Mesh mesh = eighth(1);
    for (Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices(v, 2) = radius + gap() + mesh.vertices(v, 2);
    if (two) append(mesh, eighth(1.3));
    RobotSpec spec = physical_robot(mesh);
    spec.materials[0].elastic->youngs_modulus = modulus;
    spec.materials[0].elastic->poisson_ratio = poisson;
    const Points& at = spec.mesh.vertices;
    spec.fixed = {plane_support(at, 2, radius + gap(), -gap() - approach), plane_support(at, 0, 0),
                  plane_support(at, 1, 0)};
    if (two) spec.fixed.push_back(plane_support(at, 2, -radius));
    spec.contact = contact_below(distance);
    if (!two) spec.contact->obstacles.push_back({"plate", Halfspace{{0, 0, 0}, {0, 0, 1}}, std::nullopt, {}});
    return spec;
  }

  /// An eighth of a ball around the origin, its pole at z = -radius, the cells at which are `coarser` times as large.
  [[nodiscard]] Mesh eighth(double coarser) const {
    const std::vector<double> across = places(coarser * cell, 0.18), down = places(coarser * cell, 0.1);
    const std::array<int, 3> cells{static_cast<int>(across.size()) - 1, static_cast<int>(across.size()) - 1,
                                   static_cast<int>(down.size()) - 1};
    Mesh mesh = layered_mesh(cells, {1, 1, 1}, Split::six, Split::six);
    for (Index v = 0; v < mesh.vertices.rows(); ++v) {
      const auto at = [&](int axis) {
        return static_cast<std::size_t>(std::lround(mesh.vertices(v, axis) * cells[axis]));
      };
      mesh.vertices.row(v) << across[at(0)], across[at(1)], 1 - down[down.size() - 1 - at(2)];
    }
    for (Index v = 0; v < mesh.vertices.rows(); ++v) {
      Vec3 p = mesh.vertices.row(v);
      if (p.norm() > 0) p *= radius * p.maxCoeff() / p.norm();
      mesh.vertices.row(v) << p.y(), p.x(), -p.z();  // turned, not mirrored
    }
    mesh = elevated(mesh);
    const auto length = [&](Index v) { return mesh.vertices.row(v).norm(); };
    for (const auto& [a, b, node] : edges_with_nodes(mesh))
      if (std::min(length(a), length(b)) > (1 - 1e-9) * radius) mesh.vertices.row(node) *= radius / length(node);
    return mesh;
  }

 private:
  /// From 0 to 1, even up to `even`, then growing.
  static std::vector<double> places(double first, double even) {
    const int evenly = static_cast<int>(std::ceil(even / first));
    const double step = even / evenly;
    std::vector<double> out{0};
    for (int i = 1; i <= evenly; ++i) out.push_back(step * i);
    double grown = step;
    while (out.back() < 1) out.push_back(out.back() + (grown *= 1.4));
    const double stretch = (1 - even) / (out.back() - even);
    for (double& x : out)
      if (x > even) x = even + stretch * (x - even);
    return out;
  }

  /// Another ball, its pole at the origin, turned up.
  static void append(Mesh& mesh, Mesh other) {
    const Index first = mesh.vertices.rows();
    for (Index v = 0; v < other.vertices.rows(); ++v) {
      const Vec3 p = other.vertices.row(v);
      other.vertices.row(v) << p.y(), p.x(), -p.z() - radius;
    }
    mesh.vertices.conservativeResize(first + other.vertices.rows(), 3);
    mesh.vertices.bottomRows(other.vertices.rows()) = other.vertices;
    for (Tetrahedron t : other.tetrahedra) {
      for (Index& v : t) v += first;
      mesh.tetrahedra.push_back(t);
    }
    for (EdgeNodes nodes : other.edge_nodes) {
      for (Index& v : nodes) v += first;
      mesh.edge_nodes.push_back(nodes);
    }
  }
};

/// What a pressed ball measures.
struct BallContact {
  double force = 0;     // of the whole ball [N]
  double approach = 0;  // less the gap that is left where it is pressed, weighted by force [mm]
  double radius = 0;    // of the circle in contact: sqrt(5/2 of the mean square radius of the force), Hertz' [mm]
  double rim = 0;       // radius of the outermost vertex pushed by more than a hundredth of the strongest push [mm]
  Equilibrium found{};
  Index unknowns = 0;
};

[[nodiscard]] inline BallContact pressed(const PressedBalls& balls, const StaticsOptions& options = {}) {
  const Model model = compile(balls.robot());
  const Statics statics(model);
  BallContact out;
  out.found = statics.solve({}, statics.rest(), options);
  out.unknowns = 3 * model.robot_vertices();
  const Points& at = out.found.state.positions;
  out.force = -4 * reaction_of(model, statics, out.found, 0).z();
  const Points gradient = contact_gradient(model, at);
  double sum = 0, square = 0, gaps = 0, strongest = 0;
  const double plane = balls.two ? 0 : -1;
  for (const int pass : {0, 1})
    for (Index v = 0; v < model.robot_vertices(); ++v) {
      if (model.rest(v, 2) < plane + 1e-9 && balls.two) continue;  // the upper ball
      const double push = -gradient(v, 2), r2 = at.row(v).head<2>().squaredNorm();
      if (pass == 1) {
        if (push > 0.01 * strongest) out.rim = std::max(out.rim, std::sqrt(r2));
        continue;
      }
      strongest = std::max(strongest, push);
      sum += push;
      square += push * r2;
      gaps += push * at(v, 2);
    }
  out.radius = std::sqrt(2.5 * square / sum);
  // on a plane the height of a vertex is its gap; between equal balls the plane of symmetry is not known so exactly:
  // the gap is what the mean pressure leaves
  double gap = gaps / sum;
  if (balls.two) {
    const double pressure = out.force / (M_PI * out.radius * out.radius) * 32 / 27;  // weighted by itself
    double low = 1e-3, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double z = (low + high) / 2;
      (-energy::barrier(z, 1).slope * balls.modulus > pressure ? low : high) = z;
    }
    gap = low * balls.distance;
  }
  out.approach = balls.approach + gap;
  return out;
}

/// Figures over Hertz's.
///
/// source  Hertz 1881. A ball between two plates is stiffer than his half-space, whose approach is that of points far
///         away: d' of Tatara 1991, "On compression of rubber elastic sphere over a large range of displacements", per
///         contact: d' = d + f F / (pi E), f = 2 (1 + nu) R^2 / (a^2 + 4 R^2)^1.5 + (1 - nu^2) / (a^2 + 4 R^2)^0.5
struct HertzRatios {
  double force = 0, force_of_ball = 0;  // by the approach, and by d'
  double force_of_radius = 0;           // by the radius of contact
  double radius = 0, rim = 0;           // by the approach
};

[[nodiscard]] inline HertzRatios beside_hertz(const PressedBalls& balls, const BallContact& found) {
  constexpr double r = PressedBalls::radius, nu = PressedBalls::poisson;
  const double modulus = balls.effective_modulus(), effective = balls.effective_radius(), d = found.approach;
  const double across = found.radius * found.radius + 4 * r * r;
  const double f = 2 * (1 + nu) * r * r / std::pow(across, 1.5) + (1 - nu * nu) / std::sqrt(across);
  const double stiffer = (balls.two ? 2 : 1) * f * found.force / (M_PI * PressedBalls::modulus);
  const auto force = [&](double approach) {
    return 4.0 / 3 * modulus * std::sqrt(effective) * std::pow(approach, 1.5);
  };
  const double radius = std::sqrt(effective * d);
  return {found.force / force(d), found.force / force(d + stiffer),
          found.force / (4.0 / 3 * modulus * std::pow(found.radius, 3) / effective), found.radius / radius,
          found.rim / radius};
}

}  // namespace softkin::testing
