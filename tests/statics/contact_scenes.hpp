#pragma once

#include <cmath>
#include <limits>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/statics/physical/contacts.hpp>
#include <softkin/statics/statics.hpp>

#include "model/physical_robots.hpp"

namespace softkin::testing {

/// Contact of a robot with itself below a distance.
inline ContactSpec contact_below(double distance) {
  ContactSpec contact;
  contact.distance_mm = distance;
  return contact;
}

/// Holds the vertices where an axis has a value, along it alone.
inline FixedSpec plane_support(const Points& vertices, int axis, double value, double displacement = 0) {
  VertexList list;
  for (Index v = 0; v < vertices.rows(); ++v)
    if (std::abs(vertices(v, axis) - value) < 1e-9) list.vertices.push_back(v);
  FixedSpec support{{std::move(list), {}}, {axis == 0, axis == 1, axis == 2}, {0, 0, 0}};
  support.displacement[axis] = displacement;
  return support;
}

/// A block of cells of 20 mm edge on another one of other cells, elastic, all neo-Hookean with E 1 MPa, nu 0.4. Planes
/// of symmetry at x = 0 and y = 0, and at the sides across where there are walls; the lower one stands at z = 0, the
/// top of the upper one moves down by `press`. Uneven: vertices of the upper one lie shifted along x and y.
struct StackedBlocks {
  static constexpr double size = 20;  // [mm]
  double distance, gap, press;
  bool quadratic = false, walls = false, uneven = false;

  [[nodiscard]] RobotSpec robot(const std::array<int, 3>& lower = {3, 3, 2},
                                const std::array<int, 3>& upper = {4, 4, 2}) const {
    Mesh mesh = layered_mesh(lower, Vec3::Constant(size), Split::six, Split::six);
    Mesh other = layered_mesh(upper, Vec3::Constant(size), Split::six, Split::six);
    if (uneven) shift_inside(other.vertices);
    const Index first = mesh.vertices.rows();
    mesh.vertices.conservativeResize(first + other.vertices.rows(), 3);
    mesh.vertices.bottomRows(other.vertices.rows()) = other.vertices.rowwise() + Eigen::RowVector3d(0, 0, size + gap);
    for (Tetrahedron t : other.tetrahedra) {
      for (Index& v : t) v += first;
      mesh.tetrahedra.push_back(t);
    }
    RobotSpec spec = physical_robot(quadratic ? elevated(mesh) : mesh);
    const Points& at = spec.mesh.vertices;
    spec.fixed = {plane_support(at, 2, 0), plane_support(at, 2, 2 * size + gap, -press), plane_support(at, 0, 0),
                  plane_support(at, 1, 0)};
    for (const int axis : {0, 1})
      if (walls) spec.fixed.push_back(plane_support(at, axis, size));
    spec.contact = contact_below(distance);
    return spec;
  }

  /// By less than 0.4 mm, along the sides at these.
  static void shift_inside(Points& at) {
    for (Index v = 0; v < at.rows(); ++v) {
      const double x = at(v, 0), y = at(v, 1);
      at(v, 0) += 0.4 * std::sin(M_PI * x / size) * std::cos(0.7 * x + 1.3 * y + 0.3);
      at(v, 1) += 0.4 * std::sin(M_PI * y / size) * std::sin(1.1 * x - 0.9 * y + 0.5);
    }
  }
};

/// A block of 20 mm edge over a floor at z = 0, linear or quadratic; the top moves down by `press`, planes of symmetry
/// at x = 0 and y = 0.
struct BlockOnFloor {
  static constexpr double size = 20;  // [mm]
  double distance, gap, press;
  bool quadratic = false;

  [[nodiscard]] RobotSpec robot() const {
    Mesh mesh = block_mesh({3, 3, 3}, Vec3::Constant(size));
    mesh.vertices.col(2).array() += gap;
    RobotSpec spec = physical_robot(quadratic ? elevated(mesh) : mesh);
    const Points& at = spec.mesh.vertices;
    spec.fixed = {plane_support(at, 2, size + gap, -press), plane_support(at, 0, 0), plane_support(at, 1, 0)};
    spec.contact = contact_below(distance);
    spec.contact->obstacles.push_back({"floor", Halfspace{{3, 4, 0}, {0, 0, 1}}, std::nullopt, {}});
    return spec;
  }
};

/// Slope of the barrier -(z - 1)^2 ln z in the gap over the distance, its sign turned: the pressure over the modulus.
inline double push_of_gap(double z) {
  if (!(z > 0)) return std::numeric_limits<double>::infinity();
  return z < 1 ? 2 * (z - 1) * std::log(z) + (z - 1) * (z - 1) / z : 0;
}

/// What a floor at z = 0 pushes at the points of some vertices [N], by the law of the barrier and the model's areas; on
/// edges of order 2 they are a third of the edge's height beyond the nodes.
[[nodiscard]] inline Eigen::VectorXd push_of_floor(const Model& model, const Points& positions,
                                                   const std::vector<Index>& vertices) {
  Eigen::VectorXd push(vertices.size()), height = positions.col(2);
  for (const auto& [a, b, node] : model.contact.edges)
    height[node] = 4 * positions(node, 2) / 3 - (positions(a, 2) + positions(b, 2)) / 6;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    push[i] = push_of_gap(height[vertices[i]] / model.contact.distance_mm) * model.contact.modulus_MPa *
              model.contact.area[vertices[i]];
  return push;
}

/// Force of a support on the robot [N].
[[nodiscard]] inline Vec3 reaction_of(const Model& model, const Statics& statics, const Equilibrium& found,
                                      std::size_t support) {
  return reactions(model, found.state.positions, statics.measured(found.state))[support].force;
}

/// Returns the gradient of the contact potential of a shape, in its nodes [N].
[[nodiscard]] inline Points contact_gradient(const Model& model, const Points& at) {
  const physical::Contacts contacts(model);
  const auto scratch = contacts.make_scratch();
  Team alone(1);
  contacts.find(at, *scratch, alone);
  Points gradient = Points::Zero(at.rows(), 3);
  contacts.add_gradient(at, *scratch, gradient);
  return gradient;
}

/// A block over a floor, held at its top, which moves down and sideways with the load factor.
inline RobotSpec block_on_rough_floor(double friction, const Vec3& move, int cells = 3, bool quadratic = false) {
  RobotSpec spec = physical_robot(block_mesh({cells, cells, cells}, {10, 10, 10}));
  spec.mesh_options.quadratic = quadratic;
  spec.fixed = {{{Box{{-1, -1, 9.999}, {11, 11, 11}}, {}}, {true, true, true}, move}};
  spec.contact.emplace();
  spec.contact->distance_mm = 0.05;
  spec.contact->friction = friction;
  spec.contact->obstacles.push_back({"floor", Halfspace{{0, 0, -0.06}, {0, 0, 1}}, {}, {}});
  return spec;
}

inline constexpr double gravity_m_s2 = 9.81;

/// A small block of rubber beside a floor on which a body stands, a little above it.
inline RobotSpec body_on_floor(const Vec3& size, double friction, double slope = 0) {
  RobotSpec spec = physical_robot(block_mesh({1, 1, 1}, {10, 10, 10}));
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v) spec.mesh.vertices.row(v) += Vec3(60, 0, 1).transpose();
  spec.fixed = {{{Box{{59.9, -1, -1}, {60.1, 100, 100}}, {}}, {true, true, true}, {0, 0, 0}}};
  spec.materials[0].density = 1000;
  spec.loads.gravity = gravity_m_s2 * Vec3(std::sin(slope), 0, -std::cos(slope));
  spec.contact.emplace();
  spec.contact->distance_mm = 0.05;
  spec.contact->friction = friction;
  spec.contact->obstacles.push_back({"floor", Halfspace{{0, 0, -0.06}, {0, 0, 1}}, {}, {}});
  spec.contact->bodies.push_back({"cube", Box{{0, 0, 0}, size}, {}, {}, 1000});
  return spec;
}

}  // namespace softkin::testing
